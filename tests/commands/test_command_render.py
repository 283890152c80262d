"""Flights and pictures, and the command on a terminal. usage: test_command_render.py PROGRAM"""

import json
import pathlib
import re

import command_case
from command_case import CommandCase, hierarchy, model, ply_counts, sphere
from png import read_png

BLENDS = ["linear", "smoothstep", "smootherstep", "cosine", "early", "late"]  # and step, which pops


class Render(CommandCase):
    def fly(self, *arguments, frames=12, backend="null", lode=None):
        result = self.results("render", lode or hierarchy(), "--frames", frames, "--size", "160x120",
                              "--backend", backend, *arguments)
        if "adversarial" in arguments:  # as many as the hierarchy has cells to attack
            self.assertTrue(0 < len(result["frames"]) <= frames)
        else:
            self.assertEqual(len(result["frames"]), frames)
        for frame in result["frames"]:
            self.assertGreater(frame["milliseconds"]["total"], 0)
            for key in ("cells", "triangles", "open_edges", "gap_max"):
                self.assertGreaterEqual(frame[key], 0)
        self.assertEqual(result["frame_count"], len(result["frames"]))
        for key in ("open_edges", "gap_max"):
            self.assertEqual(result[key], max(frame[key] for frame in result["frames"]))
        self.assertEqual(result["triangles"], sum(f["triangles"] for f in result["frames"]) / len(result["frames"]))
        self.assertNotIn("jump_max", result["frames"][0])
        if len(result["frames"]) > 1:
            for key in ("jump_max", "jump_pixels", "viewpoint_step"):
                self.assertEqual(result[key], max(frame[key] for frame in result["frames"][1:]))
        if "jump_over_bound" in result:
            self.assertEqual(result["jump_over_bound"], max(f["jump_over_bound"] for f in result["frames"][1:]))
            vacuous = [f["jump_bound_vacuous"] for f in result["frames"][1:]]
            self.assertEqual(result["vacuous_frames"], 100 * sum(vacuous) / len(vacuous))
        self.assertTrue(0 < result["frame_ms_median"] <= result["frame_ms_worst"])
        return result

    def assert_seamless(self, result):
        self.assertTrue(result["admissible"])
        self.assertEqual((result["open_edges"], result["gap_max"]), (0, 0))
        if len(result["frames"]) > 1:
            self.assertLessEqual(result["jump_over_bound"], 1)

    def rho(self, metric="euclidean"):
        return self.results("info", hierarchy())["kappa0_admissible_above"][metric]

    def test_no_crack_and_no_pop(self):
        for camera in ("fly-in", "orbit"):
            for metric in ("euclidean", "chebyshev"):
                uniform = ("--radii", "uniform", "--kappa0", 1.1 * self.rho(metric))
                per_level = ("--radii", "per-level", "--pixel-error", 2)
                for rule in (("--pixel-error", 1), ("--pixel-error", 4), ("--kappa0", 1), uniform, per_level):
                    result = self.fly("--camera", camera, "--metric", metric, *rule)
                    self.assert_seamless(result)
                    if camera == "fly-in":  # the orbit, seeing all, may keep clear of every band
                        self.assertGreater(result["jump_max"], 0)

    def test_blending_functions(self):
        for blend in BLENDS:
            self.assert_seamless(self.fly("--blend", blend, "--pixel-error", 2))
        popping = self.fly("--blend", "step", "--pixel-error", 2, frames=40)
        self.assertEqual(popping["open_edges"], 0)
        self.assertGreater(popping["jump_over_bound"], 1)
        few = self.fly("--blend", "step", "--pixel-error", 2, frames=4)
        self.assertGreater(few["vacuous_frames"], 0, "steps so long that an exchange keeps the bound of a morph")

    def test_cracks_below_the_admissible_radius(self):
        adversarial = ("--camera", "adversarial", "--radii", "uniform", "--kappa0")
        result = self.fly(*adversarial, 0.5 * self.rho(), "--allow-inadmissible")
        self.assertFalse(result["admissible"])
        self.assertNotIn("jump_over_bound", result, "there is no bound")
        self.assertGreater(result["open_edges"], 0)
        self.assertGreater(result["gap_max"], 0)
        self.assert_seamless_views(self.fly(*adversarial, 1.01 * self.rho()))
        # Shared vertices of cells with different parents move in deep hierarchies only.
        self.lodestone("generate", "sphere", "--triangles", 100000, "-o", "large.ply")
        self.lodestone("build", "large.ply", "-o", "deep.lode", "--cell-triangles", 50)
        deep = self.folder / "deep.lode"
        self.assert_seamless_views(self.fly("--camera", "adversarial", lode=deep))

    def assert_seamless_views(self, result):  # the camera leaps between adversarial views: jumps mean nothing
        self.assertTrue(result["admissible"])
        self.assertEqual(result["open_edges"], 0)

    def test_scene_of_several_models(self):
        (self.folder / "scene.toml").write_text(f"""
            [[model]]
            file = "{hierarchy()}"
            [[model]]
            generate = "torus"
            triangles = 20000
            position = [3, 0, 0]
            rotation = [90, 0, 0]
            [fog]
            density = 0.05
            [camera]
            frames = 4
        """)
        result = self.results("render", "scene.toml", "--size", "160x120", "-o", "frames")
        self.assert_seamless(result)
        self.assertEqual(len(result["frames"]), 4)
        self.assertEqual(result["models"], [pathlib.Path(hierarchy()).stem, "torus"])
        plan = {row["effect"]: row for row in result["effects"]}
        self.assertTrue(plan["fog"]["runs"])
        self.assertEqual(plan["fog"]["reasons"]["torus"], "the scene has fog")
        self.assertFalse(plan["texture"]["runs"])
        for frame in result["frames"]:
            self.assertGreater(frame["work"]["fog"], 0)
            self.assertNotIn("texture", frame["work"])
        everything = self.results("render", "scene.toml", "--size", "160x120", "--effects", "all", "-o", "all")
        self.assertTrue(all(row["runs"] for row in everything["effects"]))
        for frame in range(4):
            name = f"frame{frame:04}.png"
            self.assertEqual((self.folder / "frames" / name).read_bytes(), (self.folder / "all" / name).read_bytes())

    def test_mesh_is_built_first(self):
        built = self.fly("--camera", "orbit", frames=3)
        mesh = self.fly("--camera", "orbit", frames=3, lode=model("sphere.ply"))
        self.assertGreater(mesh["frames"][0]["triangles"], 0)
        self.assertEqual(len(mesh["frames"]), len(built["frames"]))

    def test_camera_at_rest_draws_once(self):
        key = {"position": [3, 0, 1], "target": [0, 0, 0]}
        (self.folder / "rest.json").write_text(json.dumps({"frames": [key]}))
        frames = self.fly("--camera", "rest.json", frames=4, backend="soft")["frames"]
        self.assertEqual([frame["drawn"] for frame in frames], [True, False, False, False])
        self.assertGreater(frames[0]["triangles"], 0)
        for frame in frames[1:]:
            self.assertEqual((frame["triangles"], frame["work"]), (0, {}))

    def test_explains_its_plan(self):
        text = self.lodestone("render", hierarchy(), "--frames", 1, "--size", "64x48", "--explain")
        self.assertRegex(text, r"(?m)^head-light +runs  a head light is on$")
        self.assertRegex(text, r"(?m)^fog +-     not called for$")
        text = self.lodestone("render", hierarchy(), "--frames", 1, "--size", "64x48", "--explain", "--effects", "fog")
        self.assertRegex(text, r"(?m)^fog +runs  the scene has fog$")
        self.assertRegex(text, r"(?m)^head-light +-     left out, though called for: a head light is on$")

    def pictures(self, backend):
        self.assert_seamless(self.fly("-o", "new/frames", backend=backend, frames=3))
        names = sorted(path.name for path in (self.folder / "new" / "frames").iterdir())
        self.assertEqual(names, ["contact.png", "frame0000.png", "frame0001.png", "frame0002.png"])
        for name in names[1:]:
            self.assertEqual(read_png(self.folder / "new" / "frames" / name)[:2], (160, 120))

    def test_soft_writes_pictures(self):
        self.pictures("soft")

    def test_gl_writes_pictures(self):
        self.needs_gl()
        self.pictures("gl")

    def test_without_opengl_soft_draws(self):
        done = command_case.call("render", hierarchy(), "--frames", 2, "--size", "64x48", "--backend", "gl", "--json", "found.json",
                                 "-o", "frames", cwd=self.folder, environment={"MESA_GL_VERSION_OVERRIDE": "3.3"})
        if not done.stderr:
            self.skipTest("the driver here is not Mesa's")
        self.assertEqual(done.returncode, 0)
        self.assertRegex(done.stderr.decode(), r"\Alodestone: [^\n]*OpenGL[^\n]*; drawing with soft instead\n\Z")
        found = json.loads((self.folder / "found.json").read_text())
        self.assertEqual(found["backend"], "soft")
        self.assertIn("OpenGL", found["fallback"])
        self.assertTrue((self.folder / "frames" / "frame0001.png").exists())

    def frames_of(self, *arguments):
        """The bytes of each frame's picture, and the rows."""
        rows = self.results("render", hierarchy(), "--frames", 10, "--size", "320x180", "--pixel-error", 2, "-o",
                            self.folder / "culled", *arguments)["frames"]
        return [(self.folder / "culled" / f"frame{k:04}.png").read_bytes() for k in range(10)], rows

    def test_culling_changes_no_picture(self):
        """Neither what others hide nor what turns its back is missed, and the proof of the frames holds."""
        expected, whole = self.frames_of()
        for options in (["--cull-occluded"], ["--cull-back-faces"], ["--cull-occluded", "--cull-back-faces"]):
            pictures, rows = self.frames_of(*options)
            self.assertEqual(pictures, expected, options)
            self.assertEqual([r["open_edges"] for r in rows], [0] * 10)
            for row, all_of_it in zip(rows, whole):
                self.assertLessEqual(row["triangles"], all_of_it["triangles"])
        hidden = sum(r["work"].get("hidden cells", 0) for r in self.frames_of("--cull-occluded")[1])
        self.assertGreater(hidden, 0)
        self.refused("render", hierarchy(), "--cull-back-faces", "--memory-budget", "1MiB", "--backend", "null",
                     names=["--cull-back-faces", "--memory-budget"])

    def test_selection_on_the_device_changes_no_picture(self):
        """By a radius for every cell, which a tolerance gives, and for every level."""
        self.needs_gl()
        drawn = []
        for rule in ([], ["--radii", "per-level"]):
            expected, by_cpu = self.frames_of("--backend", "gl", *rule)
            pictures, rows = self.frames_of("--backend", "gl", "--select-on-device", *rule)
            self.assertEqual(pictures, expected, rule)
            self.assertEqual([r["cells"] for r in rows], [r["cells"] for r in by_cpu])
            # Selection by the CPU leaves out parts of cells.
            self.assertTrue(all(r["triangles"] >= c["triangles"] for r, c in zip(rows, by_cpu)))
            self.assertTrue(all("device select" in r["milliseconds"] and r["open_edges"] == 0 for r in rows))
            drawn.append(sum(r["triangles"] for r in rows))
        self.assertNotEqual(drawn[0], drawn[1])  # without --radii it is not the rule of levels

    def test_screen_error_stays_within_the_tolerance(self):
        for tolerance in (0.5, 2):
            found = self.results("render", hierarchy(), "--backend", "null", "--frames", 4, "--no-metrics",
                                 "--pixel-error", tolerance, "--screen-error")
            self.assertEqual(found["screen_error"], max(f.get("screen_error", 0) for f in found["frames"]))
            self.assertLessEqual(found["screen_error"], tolerance)
            self.assertGreater(found["screen_error"], 0)

    def test_streaming_keeps_its_budget(self):
        """Whatever has arrived in time: no crack, no pop, and never more bytes than allowed."""
        for backend, frames in (("null", 40), ("soft", 150)):
            found = self.results("render", hierarchy(), "--memory-budget", "300KiB", "--pixel-error", 0.2, "--backend",
                                 backend, "--size", "320x180", "--frames", frames)
            self.assertEqual((found["open_edges"], found["gap_max"]), (0, 0))
            self.assertLessEqual(found["jump_over_bound"], 1)
            self.assertLess(found["first_picture_seconds"], 5)
            loaded = [frame["resident_bytes"] for frame in found["frames"]]
            self.assertLessEqual(max(loaded), 300 * 1024)
            self.assertFalse(found["frames"][0]["complete"])
        self.assertGreater(max(loaded), loaded[0])  # frames of `null` may be over before anything arrives
        self.refused("render", hierarchy(), "--memory-budget", "1KiB", "--backend", "null",
                     names=["memory budget", "1024 bytes", "allow at least"])
        self.refused("render", hierarchy(), "--memory-budget", "plenty", "--backend", "null",
                     names=["--memory-budget"])

    def test_limits_alone_move_a_streamed_picture_until_it_rests(self):
        self.write("rest.json", json.dumps({"frames": [
            {"position": [0.5, -1.2, 0.5], "target": [0.5, 0.5, 0.5], "up": [0, 0, 1], "fov_degrees": 45}]}))
        found = self.results("render", hierarchy(), "--memory-budget", "300KiB", "--pixel-error", 0.2, "--camera",
                             "rest.json", "--size", "320x180", "--frames", 400)
        frames = found["frames"][1:]
        self.assertEqual([f["jump_by_limits"] for f in frames], [f["jump_max"] for f in frames])
        self.assertGreater(max(f["jump_by_limits"] for f in frames), 0)
        self.assertEqual(max(f["jump_by_limits"] for f in frames[-40:]), 0)
        self.assertFalse(any(f["drawn"] for f in frames[-40:]))

    def test_null_writes_no_pictures(self):
        self.assert_seamless(self.fly("-o", "frames", frames=2))
        self.assertFalse((self.folder / "frames").exists())

    def test_camera_path_of_a_file(self):
        self.write("path.json", json.dumps({"frames": [
            {"position": [4, 0, 0], "target": [0, 0, 0], "up": [0, 0, 1], "fov_degrees": 45},
            {"position": [0, 2, 0], "target": [0, 0, 0], "up": [0, 0, 1], "fov_degrees": 30}]}))
        result = self.fly("--camera", "path.json", frames=5)
        self.assert_seamless(result)
        self.assertLess(result["frames"][0]["surface_triangles"], result["frames"][-1]["surface_triangles"])

    def test_zooming_does_not_pop(self):
        key = {"position": [5, 0, 0], "target": [0, 0, 0], "up": [0, 0, 1]}
        self.write("zoom.json", json.dumps({"frames": [{**key, "fov_degrees": 60}, {**key, "fov_degrees": 8}]}))
        result = self.fly("--camera", "zoom.json", frames=20)  # the camera stands still, its radii grow
        self.assert_seamless(result)
        self.assertGreater(result["jump_max"], 0)
        self.assertLess(result["frames"][0]["surface_triangles"], result["frames"][-1]["surface_triangles"])

    def test_a_single_level_flies(self):
        flat = model("flat.lode", "build", sphere(), "--levels", 0)
        for rule in (("--pixel-error", 1), ("--radii", "uniform", "--kappa0", 3)):
            result = self.fly(*rule, lode=flat, frames=3)
            self.assertEqual((result["open_edges"], result["gap_max"], result["jump_max"]), (0, 0, 0))
            self.assertNotIn("jump_over_bound", result, "nothing moves that could have a bound")
            self.assertEqual({f["surface_triangles"] for f in result["frames"]}, {ply_counts(sphere())[1]})

    def test_no_metrics_leaves_the_proof_out(self):
        result = self.results("render", hierarchy(), "--frames", 2, "--backend", "null", "--no-metrics")
        self.assertNotIn("open_edges", result)
        self.assertIn("frame_ms_median", result)


class Terminal(CommandCase):
    def test_quiet_says_nothing(self):
        for arguments in (("generate", "box", "--triangles", 1000, "-o", "m.ply"), ("build", "m.ply", "-o", "m.lode"),
                          ("info", "m.lode"), ("verify", "m.lode"), ("compare", "m.ply", "m.lode:0"),
                          ("render", "m.lode", "--frames", 2, "--backend", "null"),
                          ("export", "m.lode", "-o", "e.obj")):
            self.assertEqual(self.lodestone(*arguments, "--quiet"), "")
            self.assertNotEqual(self.lodestone(*arguments), "")

    def left_on_screen(self, shown):
        """What a terminal shows in the end: a return goes to the start of the line, ESC [K clears the rest of it."""
        lines = []
        for written in shown.replace("\r\n", "\n").split("\n"):
            line = ""
            for part in written.split("\r"):
                text, clear, rest = part.partition("\x1b[K")
                line = text + (rest if clear else line[len(text):])
            lines.append(line)
        return "\n".join(lines)

    def test_bar_of_long_work(self):
        shown = self.on_terminal("generate", "sphere", "--triangles", 200_000_000, "--threads", 1, "-o", "m.ply",
                                 interrupt_at=rb"\d+ s left", status=130)
        self.assertRegex(shown, r"\rgenerating \[#*\.*\] +\d+ %  \S+ of 200 M triangles, \S+ [kM]/s, [\dhmin ]*\d+ s left")
        self.assertRegex(self.left_on_screen(shown), r"\Alodestone: interrupted[^\n]*\n\Z")
        self.assertEqual(self.listing(), {})

    def test_phases_go_before_the_summary(self):
        for arguments, phases in ((("build", sphere(), "-o", "m.lode"), ("reading", "welding", "building", "writing")),
                                  (("verify", hierarchy()), ("reading", "verifying")),
                                  (("compare", sphere(), hierarchy()), ("reading", "comparing"))):
            shown = self.on_terminal(*arguments)
            for phase in phases:
                self.assertIn(f"\r{phase} ...", shown)
            plain = self.left_on_screen(shown)
            self.assertNotIn("...", plain)
            self.assertEqual(re.sub(r"[\d.]+", "", plain), re.sub(r"[\d.]+", "", self.lodestone(*arguments)))
            self.assertEqual(self.on_terminal(*arguments, "--quiet"), "")


if __name__ == "__main__":
    command_case.main(__doc__)
