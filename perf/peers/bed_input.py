"""The settled bed in its box of five planes, as bed.py and laws.py give it to LAMMPS and LIGGGHTS."""
from tsuji import restitution_given

SORTED = "atom_modify map array sort 1000 0.006\n"
BEGIN = {"lammps": "atom_style sphere\n" + SORTED + "newton on\ncomm_modify vel yes\n",
         "liggghts": "atom_style granular\n" + SORTED + "newton off\ncommunicate single vel yes\n"}
RUN = """units si
boundary f f f
read_data %s
neighbor %g bin
neigh_modify delay 0 every 1 check yes
%s
fix gravity all gravity 9.81 vector 0 0 -1
fix motion all nve/sphere
timestep %g
compute touching all contact/atom
compute neighbours all reduce ave c_touching
compute middle all com
thermo_style custom step atoms c_neighbours c_middle[3]
thermo %d
run %d
run ${steps}
"""


def box_of_planes(side, material):
    """The five fixed half-spaces of a scene of Epafi; side of the box [m]."""
    text = ""
    for p, n in (((0, 0, 0), (0, 0, 1)), ((0, 0, 0), (1, 0, 0)), ((0, 0, 0), (0, 1, 0)),
                 ((side, 0, 0), (-1, 0, 0)), ((0, side, 0), (0, -1, 0))):
        text += "[[body]]\nshape = { half_space = { normal = [%g, %g, %g] } }\n" % n
        text += 'material = "%s"\nfixed = true\nposition = [%.17g, %.17g, %.17g]\n' % (material, *p)
    return text


def write_data(name, bed, side, density, materials=1):
    """Rows x y z radius of the bed [m]; its spheres are of the materials by turns."""
    with open(name, "w") as f:
        f.write("settled bed\n\n%d atoms\n%d atom types\n\n" % (len(bed), materials))
        f.write("%.9g %.9g xlo xhi\n%.9g %.9g ylo yhi\n" % (-0.01, side + 0.01, -0.01, side + 0.01))
        f.write("-0.01 %.9g zlo zhi\n\nAtoms\n\n" % (bed[:, 2].max() + 0.05))
        for k, (x, y, z, r) in enumerate(bed):
            f.write("%d %d %.17g %g %.17g %.17g %.17g\n" % (k + 1, k % materials + 1, 2 * r, density, x, y, z))


def lammps_walls(law, side):
    """`law` with its style, as fix wall/gran takes it."""
    far = {"x": "%.17g" % side, "y": "%.17g" % side, "z": "NULL"}
    return "\n".join("fix wall%s all wall/gran %s %splane 0 %s" % (a, law, a, far[a]) for a in "xyz")


def liggghts_walls(model, side):
    planes = [("x", 0.0), ("x", side), ("y", 0.0), ("y", side), ("z", 0.0)]
    return "\n".join("fix wall%d all wall/gran model %s primitive type 1 %splane %.17g" % (k, model, a, at)
                     for k, (a, at) in enumerate(planes))


def script(code, data, contact, o, step):
    """The input: `contact` holds pair style and walls; o: skin, warm, steps. The call gives a variable `steps`."""
    return BEGIN[code] + RUN % (data, o.skin, contact, step, o.warm + o.steps, o.warm)
