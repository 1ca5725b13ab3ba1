"""Times one task of `cargo xtask perf` with the tool that people use for it.

    python peers.py TASK N

TASK is one of TASKS below, N the number of nodes. The section is the U with a hole that nmt is timed on. Prints one line of
JSON: {"tool", "nodes", "seconds", "peak_mb"}, seconds of the task alone by the clock, as nmt reports its own, and how far the peak of the process rose above what it
held before. Exits with 3 where the tool is not installed.
"""

import json
import sys
import time
from importlib.metadata import version

OUTLINE = [(0, 0), (4, 0), (4, 3), (3, 3), (3, 1), (1, 1), (1, 3), (0, 3)]
CENTRE, RADIUS, SIDES = (2.0, 0.5), 0.25, 64
AREA = 8 - 3.1337 * RADIUS**2
STAR = 9


def status(key):
    with open("/proc/self/status") as lines:
        return next(int(line.split()[1]) for line in lines if line.startswith(key)) / 1024


def reset_peak():
    """Lets the peak start from what is held now."""
    try:
        with open("/proc/self/clear_refs", "w") as file:
            file.write("5")
    except OSError:
        pass
    return status("VmRSS")


def measured(tool, nodes, task):
    held = reset_peak()
    start = time.perf_counter()
    result = task()
    seconds = time.perf_counter() - start
    nodes = nodes(result) if callable(nodes) else nodes
    print(json.dumps({"tool": tool, "nodes": int(nodes), "seconds": seconds, "peak_mb": status("VmHWM") - held}))


def ring():
    import numpy as np

    angle = 2 * np.pi * np.arange(SIDES) / SIDES
    return np.array(CENTRE) + RADIUS * np.stack([np.cos(angle), np.sin(angle)], 1)


def divided(loop, h):
    import numpy as np

    ends = np.roll(loop, -1, 0)
    pieces = [max(1, round(float(np.hypot(*(q - p))) / h)) for p, q in zip(loop, ends)]
    return np.vstack([p + np.arange(n)[:, None] / n * (q - p) for p, q, n in zip(loop, ends, pieces)])


def clipped_grid(h):
    """Points of a regular grid inside the section, a third of a spacing from its segments."""
    import numpy as np
    import shapely

    loops = [np.array(OUTLINE, float), ring()]
    section = shapely.Polygon(loops[0], [loops[1]])
    shapely.prepare(section)
    x, y = np.meshgrid(np.arange(h / 2, 4, h), np.arange(h / 2, 3, h))
    points = np.column_stack([x.ravel(), y.ravel()])
    points = points[shapely.contains_xy(section, points[:, 0], points[:, 1])]
    segments = np.concatenate([np.stack([loop, np.roll(loop, -1, 0)], 1) for loop in loops])
    tree = shapely.STRtree(shapely.linestrings(segments))
    near = tree.query(shapely.points(points), predicate="dwithin", distance=h / 3)[0]
    keep = np.ones(len(points), bool)
    keep[near] = False
    return [divided(loop, h) for loop in loops], points[keep]


def irregular_cloud(n):
    """Nodes, boundary first; boundary edges; number of boundary nodes; spacing."""
    import numpy as np

    h = (AREA / n) ** 0.5
    loops, interior = clipped_grid(h)
    interior += np.random.default_rng(1).uniform(-0.25 * h, 0.25 * h, interior.shape)
    edges, first = [], 0
    for loop in loops:
        k = np.arange(len(loop))
        edges.append(first + np.stack([k, (k + 1) % len(loop)], 1))
        first += len(loop)
    return np.vstack([*loops, interior]), np.vstack(edges), first, h


def stars_and_rows(points, centres):
    """The nearest nodes of every centre and their rows of u, u_x, u_y, u_xx/2, u_xy, u_yy/2, by normal equations."""
    import numpy as np
    from scipy.spatial import cKDTree

    stars = cKDTree(points).query(centres, STAR)[1]
    rows = np.empty((len(centres), 6, STAR))
    for first in range(0, len(centres), 8192):
        part = slice(first, first + 8192)
        offset = points[stars[part]] - centres[part, None]
        scale = np.sqrt((offset**2).sum(2).mean(1))[:, None]
        x, y = offset[..., 0] / scale, offset[..., 1] / scale
        square = x * x + y * y
        weight = (square + 1e-4 / (square + 1e-2)) ** -3
        basis = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], 2)
        weighted = basis * weight[..., None]
        normal = np.swapaxes(basis, 1, 2) @ weighted
        solved = np.linalg.solve(normal, np.swapaxes(weighted, 1, 2))
        rows[part] = solved / np.concatenate([scale**0, scale, scale, scale**2, scale**2, scale**2], 1)[..., None]
    return stars, rows


def cloud(n):
    measured(f"shapely {version('shapely')}", lambda found: sum(map(len, found[0])) + len(found[1]),
             lambda: clipped_grid((AREA / n) ** 0.5))


def mesh(n):
    import triangle

    points, edges, _, _ = irregular_cloud(n)
    data = {"vertices": points, "segments": edges, "holes": [CENTRE]}
    measured(f"triangle {version('triangle')}, p", len(points), lambda: triangle.triangulate(data, "p"))


def stencils(n):
    points, _, boundary, _ = irregular_cloud(n)
    measured(f"scipy {version('scipy')}, numpy {version('numpy')}", len(points) - boundary,
             lambda: stars_and_rows(points, points[boundary:]))


def assembly(n):
    import numpy as np
    import skfem
    import triangle
    from skfem.models.poisson import laplace, unit_load

    points, edges, _, _ = irregular_cloud(n)
    found = triangle.triangulate({"vertices": points, "segments": edges, "holes": [CENTRE]}, "p")
    mesh = skfem.MeshTri(np.ascontiguousarray(found["vertices"].T),
                         np.ascontiguousarray(found["triangles"].T.astype(np.int64)))

    def assemble():
        basis = skfem.CellBasis(mesh, skfem.ElementTriP1())
        return laplace.assemble(basis), unit_load.assemble(basis)

    measured(f"scikit-fem {version('scikit-fem')}", len(points), assemble)


def solve(n):
    import numpy as np
    import scipy.sparse as sp
    from pypardiso import PyPardisoSolver

    points, _, boundary, h = irregular_cloud(n)
    stars, rows = stars_and_rows(points, points[boundary:])
    values = -2 * h * h * (rows[:, 3] + rows[:, 5])
    unknowns = len(stars)
    matrix = sp.csr_matrix((values.ravel(), (np.repeat(np.arange(unknowns), STAR), stars.ravel())),
                           shape=(unknowns, len(points)))[:, boundary:].tocsr()
    matrix.sort_indices()
    del rows, values
    right = np.full(unknowns, h * h)
    solver = PyPardisoSolver(mtype=11)

    def run():
        solver.factorize(matrix)
        return solver.solve(matrix, right)

    measured(f"pypardiso {version('pypardiso')}", len(points), run)


def gmsh(n):
    import gmsh as program

    h = (2 * AREA / (3**0.5 * n)) ** 0.5
    program.initialize()
    program.option.setNumber("General.Terminal", 0)
    program.option.setNumber("General.NumThreads", 1)
    geometry, loops = program.model.geo, []
    for loop in (OUTLINE, ring().tolist()):
        corners = [geometry.addPoint(x, y, 0, h) for x, y in loop]
        lines = [geometry.addLine(p, q) for p, q in zip(corners, corners[1:] + corners[:1])]
        loops.append(geometry.addCurveLoop(lines))
    geometry.addPlaneSurface(loops)
    geometry.synchronize()
    for name, value in (("Algorithm", 6), ("MeshSizeMin", h), ("MeshSizeMax", h)):
        program.option.setNumber(f"Mesh.{name}", value)
    measured(f"gmsh {program.__version__}", lambda _: len(program.model.mesh.getNodes()[0]),
             lambda: program.model.mesh.generate(2))


TASKS = {"cloud": cloud, "mesh": mesh, "stencils": stencils, "assembly": assembly, "solve": solve, "gmsh": gmsh}

if __name__ == "__main__":
    if len(sys.argv) != 3 or sys.argv[1] not in TASKS:
        sys.exit(__doc__)
    try:
        TASKS[sys.argv[1]](int(float(sys.argv[2])))
    except ImportError as error:
        print(error, file=sys.stderr)
        sys.exit(3)
