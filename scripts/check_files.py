"""Reads every file that `nmt solve` writes for the shipped problems, and recomputes what can be recomputed.

Usage: check_files.py NMT PROBLEMS OUT
"""
import csv
import json
import pathlib
import struct
import subprocess
import sys
import xml.etree.ElementTree

import check_fem
import check_msh
import gmsh
import meshio
import numpy as np

nmt, problems, out = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
checked = 0
gmsh.initialize(readConfigFiles=False)
gmsh.option.setNumber("General.Terminal", 0)


def expect(condition, message):
    global checked
    checked += 1
    if not condition:
        sys.exit(f"check_files: {message}")


def rows_of(file):
    with open(file, newline="") as opened:
        return list(csv.DictReader(opened))


def check_edges(where, rows, report, problem):
    """τ along the edges of torsion."""
    # edges.csv has the nodes' own stresses, turned into the directions of its edges.
    node_rows = {(row["subdomain"], row["node"]): row for row in rows}
    along = rows_of(where / "edges.csv")
    for row in along:
        own = node_rows[row["subdomain"], row["node"]]
        expect(all(row[key] == own[key] for key in ("x", "y", "tau_zx", "tau_zy", "tau")), f"{problem}: edges.csv and nodes.csv differ: {row}")
        expect(row["edge"] in own["edges"].split(";"), f"{problem}: node {row['node']} of edges.csv is not on {row['edge']}")
        turned = np.hypot(float(row["tau_t"]), float(row["tau_n"]))
        expect(abs(turned - float(row["tau"])) <= 1e-12 * max(float(row["tau"]), 1e-300), f"{problem}: tau_t and tau_n of {row}")
    expect({(row["subdomain"], row["node"]) for row in along} == {key for key, row in node_rows.items() if row["kind"] != "interior"},
           f"{problem}: edges.csv has not all boundary nodes")
    for subdomain in report["subdomains"]:
        own = [row for row in along if row["subdomain"] == subdomain["name"]]
        for edge in subdomain["edges"]:
            on_it = [row for row in own if row["edge"] == edge["name"] and row["loop"] == edge["loop"]]
            s = np.array([float(row["s"]) for row in on_it])
            expect(s[0] == 0 and np.all(np.diff(s) > 0) and abs(s[-1] / edge["length"] - 1) < 1e-12, f"{problem}: s along {edge['name']}")
            expect(max(float(row["tau"]) for row in on_it) == edge["tau_max"], f"{problem}: tau_max of {edge['name']}")
        # By the trapezoidal rule on the same values: h² off, where the report takes cubics.
        for ring in subdomain["loops"]:
            names = [edge["name"] for edge in subdomain["edges"] if edge["loop"] == ring["name"]]
            total = 0.0
            for name in names:
                on_it = [row for row in own if row["edge"] == name and row["loop"] == ring["name"]]
                total += np.trapezoid([float(row["tau_t"]) for row in on_it], [float(row["s"]) for row in on_it])
            expect(abs(abs(total) / abs(ring["circulation"]) - 1) < 0.1, f"{problem}: circulation of {ring['name']}: {total}")


for problem in sorted(problems.glob("*.toml")):
    where = out / problem.stem
    subprocess.run([nmt, "solve", problem, "--out", where, "--json"], check=True, capture_output=True)
    report = json.loads((where / "report.json").read_text())
    mesh = meshio.read(where / "mesh.vtu")
    triangles = mesh.cells_dict["triangle"]
    rows = rows_of(where / "nodes.csv")

    expect(len(mesh.points) == len(rows) == report["totals"]["nodes"], f"{problem}: numbers of nodes differ")
    stars = json.loads((where / "stars.json").read_text())["subdomains"]
    of_stars = {key for key in stars[0] if key != "name"}
    is_poisson = report["subdomains"][0].get("problem") == "poisson"
    fields = ("u", "u_x", "u_y", "exact", "error") if is_poisson else ("F", "tau_zx", "tau_zy", "tau")
    expect(set(mesh.point_data) == {"node", "kind", *fields} | {f"star_{key}" for key in of_stars}, f"{problem}: point data")
    for key in of_stars:
        values = np.concatenate([part[key] for part in stars])
        expect(np.array_equal(values, mesh.point_data[f"star_{key}"]), f"{problem}: star_{key} of stars.json and mesh.vtu differ")
    expect(mesh.point_data["star_residual"].max() < 1e-10, f"{problem}: rows do not reproduce their monomials")
    indicators = set() if is_poisson else {"error_indicator"}
    expect(set(mesh.cell_data) == {"subdomain", "area", "quality", "residual"} | indicators, f"{problem}: cell data")
    for k, subdomain in enumerate(report["subdomains"] if indicators else []):
        # What the triangles contribute sums to the distance of the bounds, and more at curved edges.
        estimate, (low, high) = subdomain["error_estimate"], subdomain["error_estimate"]["J_bounds"]
        own = mesh.cell_data["error_indicator"][0][mesh.cell_data["subdomain"][0] == k]
        expect(own.min() >= 0 and own.sum() >= (high - low) * (1 - 1e-6) - 1e-13 * high, f"{problem}: error_indicator")
        off = max(abs(subdomain["J"] - low), abs(subdomain["J"] - high))
        expect(off <= estimate["J"] * (1 + 1e-9) and abs(estimate["J"] / subdomain["J"] - estimate["J_relative"]) < 1e-15, f"{problem}: {estimate}")
    xy = np.array([[float(row["x"]), float(row["y"])] for row in rows])
    expect(np.array_equal(xy, mesh.points[:, :2]), f"{problem}: coordinates of nodes.csv and mesh.vtu differ")
    for name in fields:
        values = np.array([float(row[name]) for row in rows])
        expect(np.array_equal(values, mesh.point_data[name]), f"{problem}: {name} of nodes.csv and mesh.vtu differ")
    if is_poisson:
        expect(np.array_equal(mesh.point_data["u"] - mesh.point_data["exact"], mesh.point_data["error"]), f"{problem}: error is not u less exact")
    else:
        expect(np.allclose(np.hypot(mesh.point_data["tau_zx"], mesh.point_data["tau_zy"]), mesh.point_data["tau"], rtol=1e-12),
               f"{problem}: tau is not the magnitude of its components")

    a, b, c = (mesh.points[triangles[:, k], :2] for k in range(3))
    areas = 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    expect(areas.min() > 0, f"{problem}: a triangle is not counter-clockwise")
    expect(np.allclose(areas, mesh.cell_data["area"][0], rtol=1e-9), f"{problem}: areas differ")
    for number, subdomain in enumerate(report["subdomains"]):
        own = mesh.cell_data["subdomain"][0] == number
        expect(own.sum() == subdomain["triangles"], f"{problem}: numbers of triangles differ")
        expect(abs(areas[own].sum() / subdomain["area"] - 1) < 1e-12, f"{problem}: area of the report differs")
        if is_poisson:
            own_nodes = triangles[own].ravel()
            expect(subdomain["u_max"] == mesh.point_data["u"][own_nodes].max(), f"{problem}: u_max")
            expect(subdomain["u_min"] == mesh.point_data["u"][own_nodes].min(), f"{problem}: u_min")
            expect(subdomain["errors"]["max"] == np.abs(mesh.point_data["error"][own_nodes]).max(), f"{problem}: error")
            continue
        expect(all(np.isfinite(subdomain[key]) for key in ("J", "torque", "F_max", "tau_max", "W_t")), f"{problem}: not finite")
        # Integral of the linear interpolant: close to the report's J, which has three digits more. It is off by h², which is a
        # tenth for the 80 nodes of the coarsest problem and a hundredth and less for the others.
        f = mesh.point_data["F"][triangles[own]].mean(axis=1)
        holes = sum(hole["F"] * hole["area"] for hole in subdomain["holes"])
        torque = 2 * (f * areas[own]).sum() + 2 * holes
        expect(abs(torque / subdomain["torque"] - 1) < (0.1 if subdomain["nodes"] > 200 else 0.15), f"{problem}: torque {torque} against {subdomain['torque']}")

    if not is_poisson:
        check_edges(where, rows, report, problem)
    check_msh.check(where / "mesh.msh", [part["name"] for part in report["subdomains"]], rows, mesh, expect)

    for picture in ("nodes", "mesh", "solution") if is_poisson else ("nodes", "mesh", "solution", "edges", "error"):
        root = xml.etree.ElementTree.parse(where / f"{picture}.svg").getroot()
        expect(root.tag.endswith("svg"), f"{problem}: {picture}.svg is no SVG")
        head = (where / f"{picture}.png").read_bytes()[:24]
        width, height = struct.unpack(">II", head[16:24])
        expect(head[:8] == b"\x89PNG\r\n\x1a\n" and min(width, height) > 200, f"{problem}: {picture}.png")

    if is_poisson:
        continue
    # Coarse enough for dense matrices, irregular where the problem is.
    where = out / f"{problem.stem}-fem"
    subprocess.run([nmt, "solve", problem, "--formulation", "fem", "--nodes", "31,31", "--out", where, "--json"], check=True, capture_output=True)
    report = json.loads((where / "report.json").read_text())
    check_fem.check(report, rows_of(where / "nodes.csv"), meshio.read(where / "mesh.vtu"), problem, expect)

# Several subdomains, with and without nodes in common, of a mesh and of a solution.
for name, text, is_welded in (("welded", check_msh.WELDED, True), ("separate", check_msh.SEPARATE, False)):
    problem = out / f"{name}.toml"
    problem.write_text(text)
    for command in ("mesh", "solve"):
        where = out / f"{name}-{command}"
        subprocess.run([nmt, command, problem, "--out", where, "--json"], check=True, capture_output=True)
        names = [part["name"] for part in json.loads((where / "report.json").read_text())["subdomains"]]
        found = check_msh.check(where / "mesh.msh", names, rows_of(where / "nodes.csv"), meshio.read(where / "mesh.vtu"), expect)
        expect(found == is_welded, f"{where}: welded is {found}")
        groups = [gmsh.model.getPhysicalName(*group) for group in gmsh.model.getPhysicalGroups(1)]
        expect(check_msh.INTERFACES <= set(groups), f"{where}: common edges among {groups}")

gmsh.finalize()
expect(checked > 100, "no problem was found")
print(f"{checked} passed, 0 failed")
