"""What levels cost in accuracy, for scripts/measure: against whole meshes simplified by other libraries, and against time.

Distances are those of `lodestone compare` with the input, the larger of both directions, in percent of the diagonal.
"""

import array
import pathlib
import struct
import subprocess

MODELS = ("armadillo", "igea", "lucy100k", "dragon_vrip_res2", "fandisk", "tower_holes", "bigtujunga", "sphere 1M")
CELLS = {"fandisk": ("--cell-triangles", "2500")}   # the default leaves it a single level
PEERS = ("meshoptimizer", "openmesh")
BELOW_FINEST = (1, 2, 3)
TIMED = ("sphere 1M", "terrain 1M")
SIMPLIFIERS = (("quadric", "optimal"), ("quadric", "endpoint"), ("cluster", "endpoint"), ("meshopt", "endpoint"),
               ("openmesh", "endpoint"))
HEADER = ("ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
          "element face {}\nproperty list uchar int vertex_indices\nend_header\n")


def write_height_grid(raw, target, columns, rows, spacing):
    """A mesh of a raw grid of little-endian 16-bit heights, two triangles for each of its squares."""
    heights = array.array("h", raw.read_bytes())
    places = array.array("f")
    for k, height in enumerate(heights):
        places.extend((spacing * (k % columns), -spacing * (k // columns), height))
    faces = bytearray()
    for j in range(rows - 1):
        for at in range(j * columns, (j + 1) * columns - 1):
            below = at + columns
            faces += struct.pack("<BiiiBiii", 3, at, below, below + 1, 3, at, below + 1, at + 1)
    target.write_bytes(HEADER.format(columns * rows, 2 * (columns - 1) * (rows - 1)).encode() + places.tobytes() + faces)


class Accuracy:
    def __init__(self, run, good, table, find_input, work):
        """run, good, table: of scripts/measure; find_input(name): the path of a model, None where it is missing."""
        self.run, self.good, self.table, self.find_input, self.work = run, good, table, find_input, work

    def distance(self, name, surface, path):
        """RMS and maximum; None where it could not be measured."""
        row = self.run(name, ["compare", surface, path])
        if not self.good(row):
            return None
        both = [row["result"]["forward"], row["result"]["backward"]]
        return [100 * max(side[what] for side in both) / row["result"]["diagonal"] for what in ("rms", "max")]

    def whole_mesh(self, peer, path, name, triangles):
        """Distance of what a peer makes of the whole mesh at once."""
        key = f"accuracy-{name}-{peer}-{triangles}"
        mesh = self.work / f"{key.replace(' ', '-')}.ply"
        program = pathlib.Path(self.run.program).parent.parent / "bench" / "whole_mesh"
        if not self.run.is_known(key):
            subprocess.run([program, peer, str(triangles), path, mesh], check=True, stdout=subprocess.DEVNULL)
        distance = self.distance(key, mesh, path)
        mesh.unlink(missing_ok=True)
        return distance

    def against_whole_meshes(self):
        """Levels L-1, L-2, L-3 beside whole meshes of as many triangles; shares below 1 are nearer to the input."""
        lines = []
        for name in MODELS:
            path = self.find_input(name)
            if path is None:
                continue
            lode = self.work / f"accuracy-{name.replace(' ', '-')}.lode"
            build = self.run(f"accuracy-{name}-build", ["build", path, "-o", lode, *CELLS.get(name, ())])
            if not self.good(build):
                continue
            counts = build["result"]["level_triangles"]
            for below in BELOW_FINEST:
                level = len(counts) - 1 - below
                own = self.distance(f"accuracy-{name}-level-{level}", f"{lode}:{level}", path) if level >= 0 else None
                if own is None:
                    continue
                line = [name, f"L-{below}", f"{counts[level]:,}", f"{own[0]:.4f}", f"{own[1]:.3f}"]
                for peer in PEERS:
                    theirs = self.whole_mesh(peer, path, name, counts[level])
                    if theirs is None:
                        line += ["not measured", "", ""]
                        continue
                    line += [f"{theirs[0]:.4f}", f"{theirs[1]:.3f}", f"**{own[0] / theirs[0]:.2f}**, {own[1] / theirs[1]:.2f}"]
                lines.append(line)
            if not self.run.dry:
                lode.unlink(missing_ok=True)
        header = ["model", "level", "triangles", "RMS %", "max %"]
        for peer in PEERS:
            header += [f"{peer} RMS %", "max %", "level over it: RMS, max"]
        return self.table(header, lines)

    def against_time(self):
        """Every simplifier: the rate of the whole build beside the distance of the levels."""
        lines = []
        for name in TIMED:
            path = self.find_input(name)
            for kind, placement in SIMPLIFIERS if path else ():
                key = f"accuracy-{name}-{kind}-{placement}"
                lode = self.work / f"{key.replace(' ', '-')}.lode"
                build = self.run(f"{key}-build",
                                 ["build", path, "-o", lode, "--simplifier", kind, "--placement", placement])
                if not self.good(build):
                    continue
                counts = build["result"]["level_triangles"]
                line = [name, f"{kind}, {placement}", f"{build['result']['mtri_per_core_second']:.3f}",
                        f"{build['result']['stored_triangle_ratio']:.3f}"]
                for below in BELOW_FINEST:
                    level = len(counts) - 1 - below
                    own = self.distance(f"{key}-level-{level}", f"{lode}:{level}", path) if level >= 0 else None
                    line.append(f"{own[0]:.4f}, {own[1]:.3f}" if own else "")
                lines.append(line)
                if not self.run.dry:
                    lode.unlink(missing_ok=True)
        header = ["model", "simplifier, placement", "Mtri per core-second", "stored / input"]
        return self.table(header + [f"L-{below}: RMS %, max %" for below in BELOW_FINEST], lines)
