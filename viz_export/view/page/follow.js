// A run that goes on, is resumed or made anew while its page is open.

// The folder holds another run than the one that is shown.
class MadeAnew extends Error {}

// fetch throws a TypeError where nobody answers; else it is what the server said.
function troubleOf(error) {
  return error instanceof TypeError
    ? "the server does not answer: the program that showed this run has ended"
    : error.message;
}

const anewKey = "epafi: made anew";

function loadAnew() {
  sessionStorage.setItem(anewKey, "yes");
  location.reload();
}

// Once after loadAnew.
function wasMadeAnew() {
  try {
    const was = sessionStorage.getItem(anewKey) !== null;
    sessionStorage.removeItem(anewKey);
    return was;
  } catch (e) {  // pages of files and frames have no storage in some browsers
    return false;
  }
}

class Follower extends Viewer {
  // Colours go to the ends of what is known by now, unless the user has chosen a range.
  followRange() {
    const range = this.field().range || null;
    const isTyping = [el("low"), el("high")].includes(document.activeElement);
    if (this.chosenRange || isTyping || String(range) === String(this.range)) return;
    this.resetRange();
  }

  // Asks as long as the page is open: who resumes a cut run, or makes one anew, is followed too.
  async follow() {
    if (this.source.inside || !this.manifest.identity) return;
    try {
      if (await this.source.hasChanged()) await this.readAgain();
      else this.tell("");
    } catch (e) {
      if (e instanceof MadeAnew) return loadAnew();
      this.tell(troubleOf(e));
    }
    setTimeout(() => this.follow(), this.manifest.running ? 1000 : this.trouble ? 5000 : 2000);
  }

  async readAgain() {
    const atEnd = this.at >= this.source.frames - 1;
    if (await this.source.readManifest()) {
      this.makeObjects();
      this.showColours();
      this.setTheme();
    }
    this.trouble = "";
    this.fillMeasures();
    this.manifestChanged();
    this.followRange();
    this.showMeasure();
    const last = this.source.frames - 1;
    if ((atEnd && !this.playing) || this.at > last) await this.goTo(last);
  }
}
