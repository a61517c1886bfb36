"""Random trees of bodies in Pinocchio and in headland: mass matrix, bias force and accelerations must agree.

    python validation/pinocchio_compare.py [--trees 20] [--bodies 8] [--seed 1]

Needs the packages `pin`, `numpy` and `headland`; not part of the tests. Ends with 0 if all agree to 1e-10, with 1 if
not, with 2 if a package is missing.

Each tree is made of random numbers, once as a scene and once as a `pinocchio.Model`. Ball joints have the same
quasi-velocities in both (angular velocity in the body's axes); those of a free joint's position are rates along the
parent's axes here and along the body's there, which is put right by a rotation.
"""

import argparse
import importlib
import math
import sys

def needed(name, how):
    """A package, or the end of this script with a sentence."""
    try:
        return importlib.import_module(name)
    except ImportError:
        print(f"{name} is not installed ({how}): nothing was compared", file=sys.stderr)
        sys.exit(2)


np = needed("numpy", "pip install numpy")
pin = needed("pinocchio", "pip install pin")
headland = needed("headland", "make python")

TOLERANCE = 1e-10
KINDS = ["revolute", "prismatic", "cylindrical", "universal", "planar", "spherical", "free", "weld"]
X, Y, Z = np.eye(3)


def random_inertia(rng):
    """Mass, centre and tensor about it of four points of mass."""
    masses, points = rng.uniform(0.2, 2.0, 4), rng.uniform(-1, 1, (4, 3))
    centre = masses @ points / masses.sum()
    arms = points - centre
    tensor = sum(m * (d @ d * np.eye(3) - np.outer(d, d)) for m, d in zip(masses, arms))
    return masses.sum(), centre, tensor


def random_place(rng):
    """Position and roll, pitch, yaw, with the rotation."""
    rpy = rng.uniform(-1.4, 1.4, 3)
    return rng.uniform(-1, 1, 3), rpy, pin.rpy.rpyToMatrix(*rpy)


def steps(kind, axis):
    """A joint as Pinocchio's joints in a row, each with the names of its coordinates and quasi-velocities."""
    turn, slide = pin.JointModelRevoluteUnaligned, pin.JointModelPrismaticUnaligned
    ball = (pin.JointModelSpherical(), [".qx", ".qy", ".qz", ".qw"], [".wx", ".wy", ".wz"])
    single = lambda joint, name: (joint, [name], [name + "'"])
    return {
        "weld": [],
        "revolute": [single(turn(axis), "")],
        "prismatic": [single(slide(axis), "")],
        "cylindrical": [single(slide(axis), ".slide"), single(turn(axis), ".angle")],
        "universal": [single(turn(X), ".a"), single(turn(Y), ".b")],
        "planar": [single(slide(X), ".x"), single(slide(Y), ".y"), single(turn(Z), ".angle")],
        "spherical": [ball],
        "free": [(pin.JointModelTranslation(), [".x", ".y", ".z"], [".x'", ".y'", ".z'"]), ball],
    }[kind]


def numbers(values):
    return "[" + ", ".join(repr(float(v)) for v in values) + "]"


def random_tree(rng, bodies):
    """The scene as text, the model, and the names of the model's coordinates and quasi-velocities in its order."""
    gravity = rng.uniform(-9, 9, 3)
    text = [f"title = \"tree\"\n[world]\ngravity = {numbers(gravity)}"]
    model = pin.Model()
    model.gravity.linear = gravity
    q_names, u_names = {}, {}
    ends = [(0, pin.SE3.Identity())]  # joint that carries a body, pose of the body's frame on it; the world first
    path = [0]  # Pinocchio's crba wants each branch finished before the next begins
    for b in range(bodies):
        del path[max(1, len(path) - int(rng.integers(0, 4))) :]
        parent = path[-1]
        path.append(b + 1)
        kind = KINDS[int(rng.integers(0, len(KINDS)))] if b else "revolute"
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        (at, rpy, turn), (to_at, to_rpy, to_turn) = random_place(rng), random_place(rng)
        mass, centre, tensor = random_inertia(rng)
        t = tensor
        text.append(
            f"[[body]]\nname = \"b{b}\"\nmass = {float(mass)!r}\ncenter = {numbers(centre)}\n"
            f"inertia = {numbers([t[0, 0], t[1, 1], t[2, 2], t[0, 1], t[0, 2], t[1, 2]])}"
        )
        text.append(
            f"[[joint]]\nname = \"j{b}\"\nkind = \"{kind}\"\nfrom = \"{f'b{parent - 1}' if parent else 'world'}\"\n"
            f"to = \"b{b}\"\nat = {numbers(at)}\nrpy = {numbers(rpy)}\nto_at = {numbers(to_at)}\nto_rpy = {numbers(to_rpy)}"
        )
        if kind in ("revolute", "prismatic", "cylindrical"):
            text.append(f"axis = {numbers(axis)}")
        joint, on = ends[parent]
        place = on * pin.SE3(turn, at)
        for k, (step, q, u) in enumerate(steps(kind, axis)):
            joint = model.addJoint(joint, step, place, f"j{b}_{k}")
            q_names[joint], u_names[joint] = [f"j{b}{n}" for n in q], [f"j{b}{n}" for n in u]
            place = pin.SE3.Identity()
        own = place * pin.SE3(to_turn, to_at).inverse()  # the body's frame on the last joint
        model.appendBodyToJoint(joint, pin.Inertia(mass, centre, tensor), own)
        ends.append((joint, own))
    joints = range(1, model.njoints)
    order = sorted(joints, key=lambda j: model.joints[j].idx_v)
    return "\n".join(text), model, sum((q_names[j] for j in order), []), sum((u_names[j] for j in order), [])


def relative(a, b, size):
    return float(np.abs(np.asarray(a) - np.asarray(b)).max() / max(size, 1e-300))


def compare(rng, bodies):
    """Relative differences of M, of the bias force and of the accelerations (as backward error) at random states."""
    text, model, q_names, u_names = random_tree(rng, bodies)
    equations = headland.Scene.parse(text, "tree.toml").build().equations()
    names, data, worst = equations.names, model.createData(), np.zeros(3)
    q_order = [q_names.index(n) for n in names.q]
    u_order = [u_names.index(n) for n in names.u]
    for _ in range(5):
        q = pin.randomConfiguration(model, -np.ones(model.nq), np.ones(model.nq))
        u = rng.uniform(-1, 1, model.nv)
        mass = pin.crba(model, data, q)
        mass = np.triu(mass) + np.triu(mass, 1).T
        bias = pin.nonLinearEffects(model, data, q, u)
        acceleration = pin.aba(model, data, q, u, np.zeros(model.nv))
        own_q, own_u, grid = q[q_order], u[u_order], np.ix_(u_order, u_order)
        own_mass = equations.mass(0.0, own_q, own_u)
        own_force = equations.force(0.0, own_q, own_u)
        size = np.abs(own_mass).max()
        force = max(np.abs(own_force).max(), (np.abs(own_mass) @ np.abs(own_u)).max())
        a = acceleration[u_order]
        total = (np.abs(own_mass) @ np.abs(a)).max() + np.abs(own_force).max()
        found = [
            relative(own_mass, mass[grid], size),
            relative(own_force, -bias[u_order], force),
            relative(own_mass @ a, own_force, total),
        ]
        own = equations.acceleration(0.0, own_q, own_u)
        found[2] = max(found[2], relative(own_mass @ own, own_force, total))
        worst = np.maximum(worst, found)
    return worst


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--trees", type=int, default=20)
    parser.add_argument("--bodies", type=int, default=8)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    rng = np.random.default_rng(options.seed)
    pin.seed(options.seed)
    worst = np.zeros(3)
    for k in range(options.trees):
        found = compare(rng, 1 + k % options.bodies)
        worst = np.maximum(worst, found)
        if not (found <= TOLERANCE).all():
            print(f"tree {k}: M {found[0]:.1e}, bias {found[1]:.1e}, accelerations {found[2]:.1e}")
    print(
        f"{options.trees} trees of up to {options.bodies} bodies against Pinocchio {pin.__version__}: "
        f"largest relative difference M {worst[0]:.1e}, bias {worst[1]:.1e}, accelerations {worst[2]:.1e}"
    )
    return 0 if (worst <= TOLERANCE).all() and not math.isnan(worst.sum()) else 1


if __name__ == "__main__":
    sys.exit(main())
