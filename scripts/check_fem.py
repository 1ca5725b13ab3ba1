"""Linear finite elements in NumPy on the triangles of mesh.vtu, against what `nmt solve --formulation fem` wrote."""
import numpy as np


def check(report, rows, mesh, problem, expect):
    """Solves each subdomain anew: F at nodes, τ there, J."""
    points, triangles = mesh.points[:, :2], mesh.cells_dict["triangle"]
    for number, subdomain in enumerate(report["subdomains"]):
        own = triangles[mesh.cell_data["subdomain"][0] == number]
        nodes = np.unique(own)
        local = np.searchsorted(nodes, own)
        f, tau, j = solve(points[nodes], local)
        g_theta = subdomain["torque"] / subdomain["J"]
        written = {key: np.array([float(rows[node][key]) for node in nodes]) for key in ("F", "tau_zx", "tau_zy")}
        scale = np.abs(f).max() * g_theta
        expect(np.abs(written["F"] - g_theta * f).max() < 1e-10 * scale, f"{problem}: F of fem")
        largest = np.hypot(tau[:, 0], tau[:, 1]).max() * g_theta
        found = np.column_stack([written["tau_zx"], written["tau_zy"]])
        expect(np.abs(found - g_theta * tau).max() < 1e-9 * largest, f"{problem}: τ of fem")
        expect(abs(subdomain["J"] / j - 1) < 1e-10, f"{problem}: J of fem, {subdomain['J']} against {j}")


def solve(xy, triangles):
    """F and [τ_zx, τ_zy] at nodes and J for Gθ = 1; holes have a constant each, by circulation."""
    n = len(xy)
    stiffness, load, weight, slope = np.zeros((n, n)), np.zeros(n), np.zeros(n), np.zeros((n, 2))
    corners = xy[triangles]
    edges = corners[:, [2, 0, 1]] - corners[:, [1, 2, 0]]  # opposite to each corner
    areas = 0.5 * (edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0])
    gradients = np.stack([-edges[:, :, 1], edges[:, :, 0]], axis=2) / (2 * areas)[:, None, None]
    for nodes, area, gradient in zip(triangles, areas, gradients):
        stiffness[np.ix_(nodes, nodes)] += area * gradient @ gradient.T
        load[nodes] += 2 * area / 3
    loops = boundary_loops(triangles)
    enclosed = np.array([signed_area(xy[loop]) for loop in loops])
    outer = int(np.argmax(enclosed))
    # One column an unknown: each interior node, each hole.
    is_boundary = np.zeros(n, bool)
    is_boundary[np.concatenate(loops)] = True
    interior = np.flatnonzero(~is_boundary)
    holes = [k for k in range(len(loops)) if k != outer]
    columns = np.zeros((n, len(interior) + len(holes)))
    columns[interior, np.arange(len(interior))] = 1
    for k, hole in enumerate(holes):
        columns[loops[hole], len(interior) + k] = 1
    right = columns.T @ load
    right[len(interior):] += 2 * np.abs(enclosed[holes])
    unknown = np.linalg.solve(columns.T @ stiffness @ columns, right)
    f = columns @ unknown
    j = 2 * (f[triangles].mean(axis=1) * areas).sum() + 2 * (unknown[len(interior):] * np.abs(enclosed[holes])).sum()
    for nodes, area, gradient in zip(triangles, areas, gradients):
        slope[nodes] += area * (f[nodes] @ gradient)
        weight[nodes] += area
    slope /= weight[:, None]
    return f, np.column_stack([slope[:, 1], -slope[:, 0]]), j


def boundary_loops(triangles):
    """Loops of the edges that one triangle alone has, the material on the left."""
    sides = {(a, b) for t in triangles.tolist() for a, b in zip(t, t[1:] + t[:1])}
    following = {a: b for a, b in sides if (b, a) not in sides}
    loops = []
    while following:
        first, node = following.popitem()
        loop = [first]
        while node != first:
            loop.append(node)
            node = following.pop(node)
        loops.append(np.array(loop))
    return loops


def signed_area(xy):
    following = np.roll(xy, -1, axis=0)
    return 0.5 * (xy[:, 0] * following[:, 1] - xy[:, 1] * following[:, 0]).sum()
