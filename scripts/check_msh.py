"""What Gmsh and meshio find in mesh.msh, against nodes.csv and mesh.vtu of the same run."""
import collections
import contextlib
import itertools

import gmsh
import meshio
import numpy as np

# Subdomains that share all nodes of their common edges, with names that a file has to be written with care for.
WELDED = r"""
[[subdomain]]
name = "frame"
nodes = [41, 41]
conforming = true
rectangle = { from = [0, 0], to = [4, 4] }
[[subdomain.hole]]
name = "window"
rectangle = { from = [1, 0.5], to = [3, 1.5] }
[[subdomain.hole]]
name = "bore"
circle = { centre = [2, 2.75], radius = 0.75 }
[[subdomain]]
name = 'core 3" \ é'
nodes = [31, 31]
conforming = true
circle = { centre = [2, 2.75], radius = 0.75 }
[[subdomain]]
name = "pane"
nodes = [21, 15]
irregularity = 0.2
conforming = true
rectangle = { from = [1, 0.5], to = [3, 1.5] }
[[subdomain]]
name = "block"
nodes = [17, 33]
irregularity = 0.2
rectangle = { from = [4, 1], to = [6, 5] }
"""
# The same with nodes of its own on every side.
SEPARATE = WELDED.replace("conforming = true\n", "")
# Of torsion, and of a Poisson problem.
FIELDS = ("F", "tau_zx", "tau_zy", "tau", "u", "u_x", "u_y", "exact", "error")
INTERFACES = {"frame|core 3' / é", *(f"frame|pane {n}" for n in range(1, 5)), "frame|block"}


def check(file, names, rows, vtu, expect):
    """Checks a mesh.msh; `names` are those of the subdomains, `rows` those of nodes.csv. True if it is welded."""
    gmsh.clear()
    gmsh.logger.start()
    gmsh.open(str(file))
    complaints = [line for line in gmsh.logger.get() if not line.startswith("Info")]
    gmsh.logger.stop()
    expect(not complaints, f"{file}: Gmsh says {complaints}")

    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    xy = dict(zip(tags.tolist(), coordinates.reshape(-1, 3)[:, :2].tolist()))
    expect(sorted(xy) == list(range(1, len(tags) + 1)) and not coordinates[2::3].any(), f"{file}: node numbers")
    plane = [(float(row["x"]), float(row["y"])) for row in rows]
    is_welded = len(tags) < len(rows)
    if is_welded:
        expect({tuple(p) for p in xy.values()} == set(plane) and len(set(plane)) == len(tags), f"{file}: welded nodes")
    else:
        expect([tuple(xy[tag]) for tag in sorted(xy)] == plane, f"{file}: nodes differ from nodes.csv")

    groups = {}
    for dimension, tag in gmsh.model.getPhysicalGroups():
        name = gmsh.model.getPhysicalName(dimension, tag)
        expect(name not in groups, f"{file}: two groups are named {name}")
        groups[name] = dimension, gmsh.model.getEntitiesForPhysicalGroup(dimension, tag).tolist()

    triangles = vtu.cells_dict["triangle"]
    own = vtu.cell_data["subdomain"][0]
    shown = [readable(name) for name in names]
    users = collections.defaultdict(list)  # subdomains by the side of a triangle
    for k, name in enumerate(shown):
        dimension, entities = groups[name]
        kinds, elements, nodes = gmsh.model.mesh.getElements(2, entities[0])
        expect((dimension, entities, kinds.tolist()) == (2, [k + 1], [2]), f"{file}: surface {name}")
        expect(elements[0].tolist() == (np.flatnonzero(own == k) + 1).tolist(), f"{file}: numbers of triangles of {name}")
        corners = nodes[0].reshape(-1, 3)
        same = [tuple(xy[tag]) for tag in corners.ravel().tolist()]
        expect(same == [plane[node] for node in triangles[own == k].ravel()], f"{file}: triangles of {name}")
        a, b, c = (np.array([xy[tag] for tag in corners[:, i].tolist()]) for i in range(3))
        areas = 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
        expect(areas.min() > 0, f"{file}: a triangle of {name} is not counter-clockwise")
        expect(abs(areas.sum() / vtu.cell_data["area"][0][own == k].sum() - 1) < 1e-12, f"{file}: area of {name}")
        for triangle in corners.tolist():
            for pair in itertools.combinations(sorted(triangle), 2):
                users[pair].append(k)

    wanted = segments(names, shown, rows)
    lines = {name: lines_of(entities) for name, (dimension, entities) in groups.items() if dimension == 1}
    expect(set(wanted) <= set(lines), f"{file}: edges without a name: {set(wanted) - set(lines)}")
    interfaces = {name: pairs for name, pairs in lines.items() if name not in wanted}
    inner = set().union(*interfaces.values())
    for name, (k, number) in wanted.items():
        expect(len(lines[name]) == number, f"{file}: {len(lines[name])} lines on {name}, {number} segments")
        for pair in lines[name]:
            expect(k in users[pair], f"{file}: a line of {name} is no side of a triangle of its subdomain")
            expect(len(users[pair]) == (2 if is_welded and pair in inner else 1), f"{file}: triangles along {name}")
    for name, pairs in interfaces.items():
        sides = {k for k, own_name in enumerate(shown) if own_name in name.rsplit(" ", 1)[0].split("|") + name.split("|")}
        expect(len(sides) == 2 and pairs, f"{file}: {name} is no common edge of two subdomains")
        expect(set().union(*(users[pair] for pair in pairs)) == sides, f"{file}: triangles along {name}")
        if is_welded:
            expect(all(sorted(users[pair]) == sorted(sides) for pair in pairs), f"{file}: {name} is not shared")
    expect(all(len(u) <= 2 for u in users.values()), f"{file}: a side in more than two triangles")
    on_boundary = {pair for pairs in lines.values() for pair in pairs}
    expect({pair for pair, u in users.items() if len(u) == 1} <= on_boundary, f"{file}: a bare side without a line")

    boxes(file, expect)
    views(file, vtu, triangles, is_welded, expect)
    by_meshio(file, groups, lines, len(tags), own, vtu, is_welded, expect)
    return is_welded


def readable(name):
    """A name as the file has it: readers end a name at a quotation mark, and some read a backslash as an escape."""
    return name.replace('"', "'").replace("\\", "/")


def segments(names, shown, rows):
    """Subdomain and number of segments of each edge, by its name in the file, from the edges of the boundary nodes."""
    nodes, open_edges = collections.Counter(), set()
    for row in rows:
        edges = row["edges"].split(";") if row["edges"] else []
        for edge in edges:
            nodes[row["subdomain"], edge] += 1
        # A vertex of a closed edge is on that alone.
        open_edges.update((row["subdomain"], edge) for edge in edges if len(edges) == 2)
    prefix = dict(zip(names, (f"{name}/" if len(names) > 1 else "" for name in shown)))
    return {
        prefix[subdomain] + readable(edge): (names.index(subdomain), n - ((subdomain, edge) in open_edges))
        for (subdomain, edge), n in nodes.items()
    }


def lines_of(entities):
    """The lines of curves, each by its nodes, the smaller number first."""
    pairs = []
    for entity in entities:
        _, _, nodes = gmsh.model.mesh.getElements(1, entity)
        pairs += [tuple(sorted(pair)) for pair in nodes[0].reshape(-1, 2).tolist()]
    return set(pairs)


def boxes(file, expect):
    """The envelopes that the file says its curves and surfaces have."""
    body = file.read_text().split("$Entities\n")[1].split("$EndEntities")[0].splitlines()
    n_points, n_curves, n_surfaces, _ = map(int, body[0].split())
    lines = body[1 + n_points:]
    expect(len(lines) == n_curves + n_surfaces, f"{file}: numbers of entities")
    for k, line in enumerate(lines):
        dimension = 1 if k < n_curves else 2
        tag, *box = line.split()[:7]
        _, coordinates, _ = gmsh.model.mesh.getNodes(dimension, int(tag), includeBoundary=True)
        points = coordinates.reshape(-1, 3)
        found = [*points.min(axis=0), *points.max(axis=0)]
        expect(found == [float(value) for value in box], f"{file}: envelope of entity {dimension}, {tag}")


def views(file, vtu, triangles, is_welded, expect):
    """The fields of a solution, to the bit."""
    names = [name for name in FIELDS if name in vtu.point_data]
    found = {gmsh.view.option.getString(tag, "Name"): tag for tag in gmsh.view.getTags()}
    expect(list(found) == names, f"{file}: views {list(found)}")
    for name, tag in found.items():
        kind, tags, values, _, _ = gmsh.view.getModelData(tag, 0)
        expect(kind == ("ElementNodeData" if is_welded else "NodeData"), f"{file}: view {name} is {kind}")
        rows = np.array(tags, dtype=int) - 1
        wanted = vtu.point_data[name][triangles[rows] if is_welded else rows]
        expect(np.array_equal(np.array(values).reshape(wanted.shape), wanted), f"{file}: values of {name}")


def by_meshio(file, groups, lines, n_nodes, own, vtu, is_welded, expect):
    """The same file by meshio."""
    with contextlib.redirect_stdout(None):  # it writes an empty line
        mesh = meshio.read(file)
    expect(len(mesh.points) == n_nodes, f"{file}: nodes by meshio")
    expect(len(mesh.cells_dict["triangle"]) == len(own), f"{file}: triangles by meshio")
    expect(len(mesh.cells_dict["line"]) == len(set().union(*lines.values())), f"{file}: lines by meshio")
    expect({name: entry[1] for name, entry in mesh.field_data.items()} == {name: d for name, (d, _) in groups.items()},
           f"{file}: names by meshio")
    for name, cells in mesh.cell_sets_dict.items():
        if name in groups:
            kind = "triangle" if groups[name][0] == 2 else "line"
            expect(list(cells) == [kind], f"{file}: cells of {name} by meshio")
            number = len(lines[name]) if kind == "line" else None
            expect(number in (None, len(cells[kind])), f"{file}: number of lines of {name} by meshio")
    for name in FIELDS:
        if name in vtu.point_data and not is_welded:
            by_place = [sorted(zip(m.points.tolist(), m.point_data[name].tolist())) for m in (mesh, vtu)]
            expect(by_place[0] == by_place[1], f"{file}: {name} by meshio")
