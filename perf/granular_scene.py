"""The head of granular scenes: what perf/scenes.py and perf/peers/scenes.py have in common."""

BEAD = ("bead", 2500.0, 5e6)  # name, density [kg/m3], Young's modulus [Pa]
HERTZ = 'law = "hertz-mindlin"'


def head(time_step, duration=10.0, materials=(BEAD,), restitution=0.6, friction=0.5, law=HERTZ):
    """Tables [run], [material] and [contact]: no output on the way."""
    text = f"[run]\nduration = {duration}\ntime_step = {time_step}\noutput_interval = 100.0\n"
    for name, density, modulus in materials:
        text += f"[material.{name}]\ndensity = {density}\nyoungs_modulus = {modulus:g}\npoissons_ratio = 0.3\n"
    return text + f"""[contact]
method = "smooth"
restitution = {restitution}
friction = {friction}
smooth = {{ {law} }}
"""


def plane(normal, point, name="", state="fixed = true"):
    """A half-space of beads."""
    label = f'name = "{name}"\n' if name else ""
    return f"""[[body]]
{label}shape = {{ half_space = {{ normal = {list(normal)} }} }}
position = {list(point)}
material = "bead"
{state}
"""
