#include "scenes/cli/new_scene.h"

#include <fmt/format.h>

#include "engine/units/error.h"
#include "engine/units/nearest.h"

namespace epafi {
namespace {

struct Starter {
  const char* kind;
  const char* text;
};

constexpr Starter starters[] = {
    {"impact", R"toml(title = "A glass ball dropped on a glass floor"
# `epafi check` this file, then `epafi run` it. Units: SI, or write them: "10 mm", "70 GPa".

[params]                      # names for "= expression"; change one with --set params.d=0.02
d = "10 mm"
drop = 0.1                    # m, from the lowest point of the ball to the floor

[run]
duration = 0.5                # s
time_step = "auto"            # a tenth of the shortest contact time

[world]
gravity = [0, 0, -9.81]

[material.glass]
density = 2500.0
youngs_modulus = "70 GPa"
poissons_ratio = 0.22

[contact]
method = "smooth"             # or "nonsmooth": --set contact.method=nonsmooth
restitution = 0.8             # rebound speed over impact speed
friction = 0.3

[contact.smooth]
law = "hertz-mindlin"         # `epafi list laws`

[[body]]
name = "floor"
shape = { half_space = { normal = [0, 0, 1] } }
material = "glass"
fixed = true

[[body]]
name = "ball"
shape = { sphere = { radius = "= d/2" } }
material = "glass"
position = [0, 0, "= d/2 + drop"]

[[measure]]
name = "height"
kind = "position"             # `epafi list measures`
body = "ball"
interval = 1e-3               # s

[bounds]                      # a violation ends the run with exit code 1
energy_error = 1e-2
)toml"},
    {"stack", R"toml(title = "Ten boxes on each other"
[params]
n = 10                        # boxes: --set params.n=20
a = 1.0                       # m, edge

[run]
duration = 10.0               # s
time_step = "= 1/240"

[world]
gravity = [0, 0, -9.81]

[material.stone]
density = 1000.0

[contact]
method = "nonsmooth"          # rigid bodies; impulses from a solver
restitution = 0.0
friction = 0.5

[contact.nonsmooth]
solver = "adaptive"           # the default; `epafi list solvers`
iterations = 50

[[body]]
name = "floor"
shape = { half_space = { normal = [0, 0, 1] } }
material = "stone"
fixed = true

[[body]]
name = "stack"
repeat = "= n"                # i runs over 0 .. n-1
shape = { box = { size = ["= a", "= a", "= a"] } }
material = "stone"
position = [0, 0, "= (i + 0.5)*a"]

[[measure]]
name = "drift"
kind = "drift"
body = "stack"
interval = 0.1                # s

[bounds]
overlap_relative = 1e-2
)toml"},
    {"pile", R"toml(title = "Pebbles that settle in a tray"
[params]
n = 300                       # pebbles
d = 0.05                      # m, diameter

[run]
duration = 2.0                # s
time_step = 2e-3

[world]
gravity = [0, 0, -9.81]
domain = { min = [-2, -2, -1], max = [2, 2, 20] }   # leaving it is an error

[material.stone]
density = 2600.0

[contact]
method = "nonsmooth"
restitution = 0.0
friction = 0.5

[contact.nonsmooth]
solver = "adaptive"
iterations = 50

[shape.pebble]                # 16 corners by chance; their hull is taken
polyhedron = { random = { vertices = 16, seed = 3 } }
scale_to_diameter = "= d"

[[body]]
name = "floor"
shape = { half_space = { normal = [0, 0, 1] } }
material = "stone"
fixed = true

[[body]]
name = "walls"                # four planes around a square of 12 pebbles, facing inwards
repeat = 4
shape = { half_space = { normal = ["= cos(i*pi/2)", "= sin(i*pi/2)", 0] } }
material = "stone"
position = ["= -6*d*cos(i*pi/2)", "= -6*d*sin(i*pi/2)", 0]
fixed = true

[[fill]]
shape = ["pebble"]
material = "stone"
count = "= n"
region = { box = { min = ["= -6*d", "= -6*d", 0], max = ["= 6*d", "= 6*d", "= 2*n*d/50 + 4*d"] } }

[[measure]]
name = "energy"
kind = "energy"
interval = 0.02               # s
)toml"},
    {"hopper", R"toml(title = "Beads that leave a box when its gate opens"
[params]
n = 500                       # beads
d = 0.010                     # m, diameter
w = "= 12*d"                  # inner width of the box

[run]
duration = 1.5                # s
time_step = "auto"
output_interval = 0.02        # s

[world]
gravity = [0, 0, -9.81]
domain = { min = [-1, -1, -0.5], max = [1, 1, 2], outside = "delete" }

[material.bead]               # soft on purpose: the time step grows, the flow hardly changes
density = 2500.0
youngs_modulus = "10 MPa"
poissons_ratio = 0.25

[contact]
method = "smooth"
restitution = 0.6
friction = 0.4

[contact.smooth]
law = "hertz-mindlin"

[shape.bead]
sphere = { radius = "= d/2" }

[[body]]
name = "walls"                # four planes, facing inwards
repeat = 4
shape = { half_space = { normal = ["= cos(i*pi/2)", "= sin(i*pi/2)", 0] } }
material = "bead"
position = ["= -w/2*cos(i*pi/2)", "= -w/2*sin(i*pi/2)", 0]
fixed = true

[[body]]
name = "bottom"               # two plates leave a slit of 5 diameters
repeat = 2
shape = { box = { size = ["= (w - 5*d)/2 + d", "= w + 2*d", "= d"] } }
material = "bead"
position = ["= (2*i - 1)*((w + 5*d)/4 + d/2)", 0, "= -d/2"]
fixed = true

[[body]]
name = "gate"                 # closes the slit until the beads rest
shape = { box = { size = ["= 6*d", "= w + 2*d", "= d"] } }
material = "bead"
position = [0, 0, "= -1.5*d"]
fixed = true
remove_at = 0.5               # s

[[fill]]
shape = ["bead"]
material = "bead"
count = "= n"
region = { box = { min = ["= -w/2", "= -w/2", 0], max = ["= w/2", "= w/2", "= 2*n*d^3/w^2 + 4*d"] } }

[[measure]]
name = "outflow"
kind = "mass_flow"            # rate and mass through a plane
plane = { point = [0, 0, "= -2.5*d"], normal = [0, 0, -1] }
interval = 0.01               # s
)toml"},
};

}  // namespace

const std::vector<std::string>& starter_kinds() {
  static const std::vector<std::string> kinds = [] {
    std::vector<std::string> names;
    for (const auto& starter : starters) names.emplace_back(starter.kind);
    return names;
  }();
  return kinds;
}

std::string starter_scene(std::string_view kind) {
  for (const auto& starter : starters)
    if (kind == starter.kind) return starter.text;
  if (kind.empty())
    throw SceneError(fmt::format("which starter scene? There are: {}", fmt::join(starter_kinds(), ", ")));
  throw SceneError("there is no starter scene '" + std::string(kind) + "'" +
                   suggestion(kind, starter_kinds(), "available"));
}

}  // namespace epafi
