"""A section of scripts/measure: what each effect costs in the example scenes, and what the planner saves."""

import pathlib
import statistics

SCENES = pathlib.Path("experiments/scenes")
FRAMES = {"soft": 24, "gl": 8}
ROUNDS = 3


class EffectCosts:
    """Runs what it needs by `run`."""

    def __init__(self, run, good, table):
        self.run, self.good, self.table = run, good, table

    def render(self, scene, backend, label, effects, turn):
        return self.run(f"effects-{scene.stem}-{backend}-{label}-{turn}",
                        ["render", scene, "--backend", backend, "--frames", FRAMES[backend], "--effects", effects, "--no-metrics"])

    def milliseconds(self, scene, backend, configurations):
        """Median over frames and rounds of each configuration; rounds are interleaved, so that a busy machine is fair."""
        times = {label: [] for label in configurations}
        for turn in range(ROUNDS):
            for label, effects in configurations.items():
                row = self.render(scene, backend, label, effects, turn)
                if not self.good(row):
                    return None
                frames = row["result"]["frames"][1:]       # the first one uploads and compiles
                times[label].append(statistics.median(frame["milliseconds"]["total"] for frame in frames))
        return {label: (statistics.median(values), min(values), max(values)) for label, values in times.items()}

    def __call__(self):
        totals, parts = [], []
        for scene in sorted(SCENES.glob("*.toml")):
            for backend in FRAMES:
                first = self.render(scene, backend, "auto", "auto", 0)
                if not self.good(first):
                    continue
                running = [row["effect"] for row in first["result"]["effects"] if row["runs"]]
                configurations = {"auto": "auto", "all": "all"}
                for effect in running:
                    rest = [other for other in running if other != effect]
                    configurations[f"without-{effect}"] = ",".join(rest) or "none"
                times = self.milliseconds(scene, backend, configurations)
                if times is None:
                    continue
                (auto, low, high), (everything, least, most) = times["auto"], times["all"]
                totals.append([scene.stem, backend, f"{auto:.1f} ({low:.1f}-{high:.1f})",
                               f"{everything:.1f} ({least:.1f}-{most:.1f})", f"{everything - auto:.1f}",
                               f"{100 * (1 - auto / everything):.0f} %"])
                costs = sorted(((auto - times[f"without-{effect}"][0], effect) for effect in running), reverse=True)
                parts.append([scene.stem, backend, ", ".join(f"{effect} {cost:.1f}" for cost, effect in costs)])
        return "\n".join([
            self.table(["scene", "backend", "ms a frame, planned", "with everything on", "saved, ms", "saved"], totals), "",
            self.table(["scene", "backend", "ms that a frame gains without the effect"], parts)])
