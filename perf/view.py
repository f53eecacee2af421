#!/usr/bin/env python3
"""What the viewer costs: page size and memory, time of a picture in a headless Chromium without a graphics processor,
and in `epafi render`.
   /usr/bin/python3 perf/view.py [build/bin/epafi]     measures, writes perf/view.csv and the table of
   docs/performance/view.md /usr/bin/python3 perf/view.py --table               writes the table again from
   perf/view.csv
Needs Chromium (SwiftShader draws) and nothing else. Times are of the clock: `load` in the file says what else ran."""
import base64
import csv
import json
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
CSV, TABLE = ROOT / "perf/view.csv", ROOT / "docs/performance/view.md"
HOPPER = ["scenes/library/hopper/hopper.toml", "--set", "params.open_at=0.3", "--set", "run.duration=0.6", "--set",
          "run.output_interval=0.006",
          "--set", "run.checkpoint_interval=1"]
MANY = ["scenes/library/bed/bed.toml", "--set", "params.n=200000", "--set", "run.output_interval=0.002", "--until",
        "0.02"]
COLUMNS = ["what", "value", "unit", "needed", "load"]


class Browser:
    """Chromium by the DevTools protocol on two pipes, as tests/support/browser.h."""

    def __init__(self, width, height):
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        to_read, self.to = os.pipe()
        self.answers, from_write = os.pipe()
        options = ["--headless=new", "--no-sandbox", "--remote-debugging-pipe", "--hide-scrollbars",
                   "--use-angle=swiftshader",
                   "--enable-unsafe-swiftshader", "--no-first-run", "--disable-extensions",
                   "--disable-background-networking",
                   "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1", "--force-device-scale-factor=1",
                   f"--user-data-dir={self.profile.name}", f"--window-size={width},{height}"]
        start = f'exec chromium "$@" 3<&{to_read} 4>&{from_write}'
        self.process = subprocess.Popen(["bash", "-c", start, "bash", *options], pass_fds=(to_read, from_write),
                                        stderr=subprocess.DEVNULL)
        os.close(to_read)
        os.close(from_write)
        self.received, self.last, self.session, self.complaints = b"", 0, None, []
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", flatten=True, targetId=target)["sessionId"]
        for domain in ["Runtime.enable", "Log.enable", "Page.enable"]:
            self.call(domain)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait()
        self.profile.cleanup()

    def call(self, method, **parameters):
        return self.send(method, parameters, self.session)

    def send(self, method, parameters, session):
        self.last += 1
        message = {"id": self.last, "method": method, "params": parameters}
        if session:
            message["sessionId"] = session
        left = json.dumps(message).encode() + b"\0"
        while left:
            left = left[os.write(self.to, left):]
        while True:
            answer = self.next_message()
            if answer.get("id") == self.last:
                return answer["result"]
            self.keep_complaint(answer)

    def next_message(self):
        while b"\0" not in self.received:
            piece = os.read(self.answers, 1 << 20)
            if not piece:
                raise RuntimeError("the browser has gone")
            self.received += piece
        message, self.received = self.received.split(b"\0", 1)
        return json.loads(message)

    def keep_complaint(self, event):
        method, parameters = event.get("method"), event.get("params", {})
        if method == "Runtime.exceptionThrown" or (method == "Runtime.consoleAPICalled"
                                                   and parameters["type"] in ("error", "warning")):
            self.complaints.append(json.dumps(parameters)[:400])
        if method == "Log.entryAdded" and parameters["entry"]["level"] == "error":
            self.complaints.append(parameters["entry"]["text"])

    def value(self, expression):
        answer = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(answer["exceptionDetails"].get("exception", {}).get("description", expression))
        return answer["result"].get("value")

    def wait_for(self, expression, seconds=120):
        end = time.monotonic() + seconds
        while not self.value(f"Boolean({expression})"):
            if time.monotonic() > end:
                raise RuntimeError("never true: " + expression)
            time.sleep(0.05)

    def open(self, address):
        self.call("Page.navigate", url=address)
        self.wait_for("document.body && document.body.dataset.ready === 'true'")

    def script_memory(self):
        """Objects of the page's script after a collection, without the arrays they hold [bytes]."""
        self.call("HeapProfiler.collectGarbage")
        self.call("Performance.enable")
        return {m["name"]: m["value"] for m in self.call("Performance.getMetrics")["metrics"]}["JSHeapUsedSize"]

    def page_memory(self):
        """What the processes hold that run and draw the page; shared pages count in parts [bytes]."""
        total = 0
        for process in self.send("SystemInfo.getProcessInfo", {}, None)["processInfo"]:
            if process["type"] not in ("renderer", "GPU"):
                continue
            text = pathlib.Path(f"/proc/{process['id']}/smaps_rollup").read_text()
            total += 1024 * sum(int(line.split()[1]) for line in text.splitlines() if line.startswith("Pss:"))
        return total

    def picture(self, path):
        pathlib.Path(path).write_bytes(base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"]))


# Pictures that reach the screen in five seconds, while the camera turns.
TURN = """new Promise((done) => {
  const start = performance.now(), drawn = epafi.drawn;
  const step = (now) => {
    if (now - start > 5000) return done((epafi.drawn - drawn) / (now - start) * 1000);
    epafi.camera.position.x *= 1.0001;
    epafi.dirty = true;
    requestAnimationFrame(step);
  };
  requestAnimationFrame(step);
})"""
# Frames of the run that are decoded, sent to the graphics processor and drawn, a second.
PLAY = """(async () => {
  const start = performance.now();
  const n = Math.min(40, epafi.source.frames);
  for (let k = 0; k < n; ++k) {
    const drawn = epafi.drawn;
    await epafi.goTo(epafi.source.frames - n + k);
    epafi.dirty = true;  // the frame that is shown already is drawn too
    while (epafi.drawn === drawn) await new Promise(requestAnimationFrame);
  }
  return n / (performance.now() - start) * 1000;
})()"""
# Every frame of the run, shown once.
ALL = """(async () => {
  for (let k = 0; k < epafi.source.frames; ++k) await epafi.goTo(k);
  epafi.dirty = true;
  await new Promise(requestAnimationFrame);
})()"""
# Fields of 32 x 18 in which something else than the background is seen.
FIELDS = """(() => {
  const gl = epafi.renderer.getContext(), w = gl.drawingBufferWidth, h = gl.drawingBufferHeight;
  const p = new Uint8Array(4 * w * h);
  gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, p);
  const seen = new Set();
  for (let y = 0; y < h; ++y) for (let x = 0; x < w; ++x)
    if (p[4 * (y * w + x)] < 230) seen.add(Math.floor(y * 18 / h) * 32 + Math.floor(x * 32 / w));
  return seen.size;
})()"""


class Table:
    def __init__(self):
        self.rows = []

    def add(self, what, value, unit, needed=""):
        self.rows.append([what, f"{value:.3g}" if value < 1000 else f"{value:.0f}", unit, needed,
                          f"{os.getloadavg()[0]:.1f}"])
        print(*self.rows[-1], sep=", ", flush=True)

    def write(self):
        with open(CSV, "w", newline="") as out:
            csv.writer(out, lineterminator="\n").writerows([COLUMNS, *self.rows])


def write_document():
    begin, end = "<!-- table of perf/view.csv -->\n", "<!-- end of the table -->"
    with open(CSV, newline="") as rows:
        lines = ["| " + " | ".join(row) + " |\n" for row in csv.reader(rows)]
    lines.insert(1, "|---|---|---|---|---|\n")
    head, rest = TABLE.read_text().split(begin)
    TABLE.write_text(head + begin + "".join(lines) + end + rest.split(end)[1])


def processor_time(command, **more):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, cwd=ROOT, **more)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def measure_render(table, epafi, run, folder):
    """One picture, and what each further frame of a film takes; a stand-in for ffmpeg throws the frames away."""
    ffmpeg = folder / "ffmpeg"
    ffmpeg.write_text("#!/bin/sh\ncat >/dev/null\n")
    ffmpeg.chmod(0o755)
    path = {**os.environ, "PATH": f"{folder}:{os.environ['PATH']}"}
    command = [epafi, "render", run, "--size", "1280x720"]
    films = {every: min(processor_time([*command, "--every", every, "--out", folder / "film.mp4"], env=path)
                        for _ in range(3)) for every in ["100", "10"]}
    table.add("hopper of 20 000: a frame of a film of 1280x720 by `epafi render`", (films["10"] - films["100"]) / 9,
              "s of one core", "< 0.5")
    single = min(processor_time([*command, "--out", folder / "picture.png"]) for _ in range(3))
    table.add("the same: one picture, with the program's start and its look at 101 frames", single, "s of one core")


def measure_writing(table, epafi, run, page):
    start = time.monotonic()
    used = processor_time([epafi, "view", run, "-o", page])
    table.add("hopper of 20 000, 101 frames: writing the page", used, "s of one core")
    table.add("the same by the clock", time.monotonic() - start, "s")


def measure_page(table, name, page, needed):
    with Browser(1280, 720) as browser:
        start = time.monotonic()
        browser.open(page.as_uri())
        table.add(f"{name}: page opens", time.monotonic() - start, "s")
        opened = browser.page_memory() / 1e6
        table.add(f"{name}: non-empty fields of 576", browser.value(FIELDS), "fields", "> 20")
        table.add(f"{name}: camera turning", browser.value(TURN), "pictures/s", needed)
        if browser.value("epafi.source.frames") > 1:
            table.add(f"{name}: playback", browser.value(PLAY), "frames/s", needed)
        table.add(f"{name}: memory of the page, opened", opened, "MB")
        browser.value(ALL)
        table.add(f"{name}: memory of the page after all frames", browser.page_memory() / 1e6, "MB")
        table.add(f"{name}: of that, script objects", browser.script_memory() / 1e6, "MB")
        table.add(f"{name}: errors in the browser", len(browser.complaints), "", "0")


def main():
    if "--table" in sys.argv:
        return write_document()
    epafi = str(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "build/bin/epafi").resolve())
    table = Table()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        run, page, many = folder / "hopper", folder / "hopper.html", folder / "many.html"
        subprocess.run([epafi, "run", *HOPPER, "-q", "-o", run], check=True, cwd=ROOT)
        measure_writing(table, epafi, run, page)
        table.add("hopper of 20 000, 101 frames: page", page.stat().st_size / 1e6, "MB", "< 30")
        measure_page(table, "hopper of 20 000", page, ">= 5")
        bed = folder / "bed"
        subprocess.run([epafi, "run", *MANY, "-q", "-o", bed], check=True, cwd=ROOT)
        subprocess.run([epafi, "view", bed, "-o", many], check=True, cwd=ROOT)
        table.add("200 000 spheres, 11 frames: page", many.stat().st_size / 1e6, "MB", "< 30")
        measure_page(table, "200 000 spheres", many, "")
        measure_render(table, epafi, run, folder)
    table.write()
    return write_document()


if __name__ == "__main__":
    main()
