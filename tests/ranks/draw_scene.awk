# Prints a scene drawn at random: awk -v seed=N -f draw_scene.awk. Grains of some kinds, loose or in a box, in a cell
# that repeats or not, with walls that rest, swing or press, and with whatever comes, goes or changes on the way.
function one_in(n) { return int(n * rand()) == 0 }
function any_of(list, parts) { return parts[1 + int(split(list, parts, "|") * rand())] }
function between(a, b) { return sprintf("%.4g", a + (b - a) * rand()) }
function entry(table, name) { printf "[[%s]]\nname = \"%s\"\n", table, name }
function motion() {
  if (one_in(3))
    return "motion = { table = [[0, 0, 0, 0], [0.01, " between(0, 0.002) ", 0, " between(-0.001, 0.001) \
           "], [0.03, 0, 0, 0], [1, 0, 0, 0]], of = \"displacement\" }"
  return "motion = { oscillation = { direction = [" any_of("0|1") ", 0, 1], amplitude = 0.001, frequency = " \
         between(20, 60) " } }"
}
function wall(name, normal, position, what) {
  entry("body", name)
  printf "material = \"n\"\nshape = { half_space = { normal = [%s] } }\nposition = [%s]\n%s\n", normal, position, what
}
function walls_across(first, second, normal, end) {
  wall(first, normal, "0, 0, 0", "fixed = true")
  gsub("1", "-1", normal)
  wall(second, normal, end, "fixed = true")
}
function fill(name, count, velocity, low, high, more) {
  entry("fill", name)
  printf "shape = [%s]\nmaterial = \"%s\"\ncount = %d\nvelocity = [%s]\n", grains, any_of("m|n"), count, velocity
  printf "region = { box = { min = [%s], max = [%s] } }\n%s\n", low, high, more
}
function measure(name, kind, more) {
  entry("measure", name)
  printf "kind = \"%s\"\ninterval = %s\n%s\n", kind, any_of("0.001|0.005|0.007"), more
}

function draw_contact(law) {
  printf "contact.restitution = %s\ncontact.friction = %s\n", between(0.2, 0.9), between(0, 0.8)
  if (one_in(4)) { print "contact.method = \"nonsmooth\""; return }
  print "contact.method = \"smooth\""
  law = any_of("hertz|hertz|rolling|linear|jkr")
  if (law == "linear") print "contact.smooth = { law = \"linear\", stiffness = 500 }"
  if (law == "jkr") print "contact.smooth = { law = \"jkr\", work_of_adhesion = 0.2 }"
  if (law == "rolling")
    print "contact.rolling_friction = 0.05\ncontact.smooth = { law = \"hertz-mindlin\", rolling = \"spring\" }"
}
function draw_grains(k) {
  if (one_in(3)) return "\"ball\", \"bead\""
  grains = "\"four\""
  for (k = 0; k < 3; ++k) grains = grains ", \"" any_of("ball|bead|pair|four|box|rod|stone|drop") "\""
  return grains
}
function draw_walls(periodic, k, held, names) {
  wall("floor", "0, 0, 1", "0, 0, 0", one_in(3) ? motion() : "fixed = true")
  if (periodic !~ "x") walls_across("west", "east", "1, 0, 0", "0.1, 0, 0")
  if (periodic !~ "y" && one_in(2)) walls_across("south", "north", "0, 1, 0", "0, 0.08, 0")
  if (has_lid)
    wall("lid", "0, 0, -1", "0, 0, 0.11",
         "motion = { servo = { force = 2.0, direction = [0, 0, -1], mass = 0.05, max_speed = 1.0 } }")
  split("ball|four|box|net|stone", names, "|")
  for (k = 1; k <= 5; ++k) {
    if (!one_in(3)) continue
    held = names[k]
    entry("body", "held_" held)
    printf "shape = \"%s\"\nmaterial = \"n\"\nposition = [%s, %s, 0.01]\n", held, between(0.02, 0.08),
           between(0.02, 0.06)
    print one_in(2) ? "fixed = true" : motion()
  }
}
function draw_stages() {
  entry("stage", "first")
  print "duration = " between(0.005, 0.03)
  entry("stage", "then")
  print "duration = 0.08"
  if (one_in(3)) print "world.gravity = [\"= 5*sin(2*pi*30*t)\", 0, -9.81]"
  else if (one_in(2)) print "body.floor = { fixed = false, " motion() " }"
}
function draw_measures() {
  measure("coordination", "coordination")
  if (one_in(2)) measure("energy", "energy")
  if (one_in(2)) measure("chains", "force_chains")
  if (one_in(2)) measure("weight", "force", "body = \"floor\"")
  if (one_in(2)) measure("load", "contact", "between = [\"grains\", \"floor\"]")
  if (one_in(2)) measure("stress", "stress", "region = { box = { min = [0.01, 0.01, 0], max = [0.09, 0.07, 0.05] } }")
  if (has_outlet) measure("flow", "outlet", "outlet = \"out\"")
}

BEGIN {
  srand(seed)
  for (k = 0; k < 8; ++k) rand() # the first ones of near seeds are near each other
  periodic = any_of("|\"x\"|\"x\", \"y\"")
  has_lid = one_in(3)
  has_outlet = one_in(2)
  print "run = { time_step = 5e-5, output_interval = 0.005, checkpoint_interval = 0.02, seed = " seed " }"
  print "world.gravity = [" between(-3, 3) ", " between(-3, 3) ", -9.81]"
  printf "world.domain = { min = [0, 0, -0.1], max = [0.1, 0.08, 0.5], %soutside = \"delete\" }\n",
         periodic == "" ? "" : "periodic = [" periodic "], "
  split("m|n", materials, "|")
  for (k = 1; k <= 2; ++k)
    printf "material.%s = { density = %s, youngs_modulus = \"2 MPa\", poissons_ratio = 0.3 }\n", materials[k],
           between(800, 3000)
  draw_contact()
  print "shape.ball = { sphere = { radius = 0.006 } }"
  print "shape.bead = { sphere = { radius = 0.004 } }"
  print "shape.pair = { clump = { spheres = [[0, 0, 0, 0.005], [0.005, 0, 0, 0.004]] } }"
  print "shape.four.clump.spheres = " \
        "[[0, 0, 0, 0.004], [0.004, 0, 0, 0.004], [0, 0.004, 0, 0.003], [0, 0, 0.005, 0.003]]"
  print "shape.box = { box = { size = [0.012, 0.009, 0.007] } }"
  print "shape.rod = { capsule = { radius = 0.003, length = 0.008 } }"
  print "shape.stone.polyhedron.vertices = " \
        "[[-0.006, -0.006, -0.005], [0.007, -0.006, -0.005], [0, 0.008, -0.005], [0, 0, 0.007]]"
  print "shape.drop = { ellipsoid = { semi_axes = [0.006, 0.004, 0.003] } }"
  print "shape.net.mesh.file = \"net.obj\""
  grains = draw_grains()
  draw_walls(periodic)
  fill("grains", between(30, 100), between(-0.5, 0.5) ", 0, -1", "0.004, 0.004, 0.018", "0.096, 0.076, 0.108",
       "velocity_deviation = 0.4")
  if (!has_lid && one_in(3))
    fill("poured", 20, "0, 0, -2", "0.01, 0.01, 0.15", "0.09, 0.07, 0.2", "method = \"pour\"\nrate = 800")
  if (has_outlet) {
    entry("outlet", "out")
    printf "region = { box = { min = [%s, -1, -1], max = [1, 1, 0.02] } }\n", between(0.04, 0.08)
  }
  draw_stages()
  draw_measures()
}
