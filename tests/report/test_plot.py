"""What the plots say, by the SVG that is written; and the files of a figure."""

import io
import re
import unittest
import xml.etree.ElementTree as ET

from report_case import FolderCase
from lodestone_report import plot
from lodestone_report.figures import Figure, Panel, Point, Series


def point(x, y, reach=1.0):
    return Point(x, x / reach, x * reach, y, y, y)


def panel(series, more_is_better=False):
    return Panel("y", "", more_is_better, [Series(name, points) for name, points in series.items()])


def figure(*panels, kind="line", x_name="x", **more):
    return Figure("", kind, x_name, panels=list(panels), **more)


def drawn(what):
    return ET.parse(io.StringIO(plot.to_svg(what.plot())))


def texts(svg):
    return [text.text for text in svg.iter(f"{{{plot.SVG}}}text")]


class Plot(unittest.TestCase):
    def colour(self, svg, group):
        shape = next(g for g in svg.iter(f"{{{plot.SVG}}}g") if g.get("id") == group)
        return re.search("fill: (#[0-9a-f]{6})", ET.tostring(shape, encoding="unicode"))[1]

    def test_bars_have_the_colour_of_the_legend_in_every_panel(self):
        svg = drawn(figure(panel({"s": [point(0, 1)], "t": [point(0, 2)]}), panel({"t": [point(0, 3)], "s": [point(0, 4)]}),
                           kind="bar", categories=["one"]))
        self.assertEqual(self.colour(svg, "points-0-0-0"), self.colour(svg, "points-1-1-0"), "s")
        self.assertEqual(self.colour(svg, "points-0-1-0"), self.colour(svg, "points-1-0-0"), "t")
        self.assertNotEqual(self.colour(svg, "points-0-0-0"), self.colour(svg, "points-0-1-0"))

    def test_the_ninth_series_is_not_the_first_once_more(self):
        names = [f"s{n:02}" for n in range(18)]
        what = figure(panel({name: [point(0, 1 + n)] for n, name in enumerate(names)}), kind="bar", categories=["one"])
        bars = ET.fromstring(plot.for_page(plot.to_svg(what.plot()), what, "f0"))
        groups = [next(g for g in bars.iter(f"{{{plot.SVG}}}g") if g.get("id") == f"f0-points-0-{n}-0") for n in range(18)]
        looks = [re.findall("(?:fill|stroke): ([^;\"]+)", ET.tostring(group, encoding="unicode")) for group in groups]
        self.assertEqual(len({tuple(look) for look in looks}), 18)
        hatches = [re.search(r"fill: url\(#([^)]*)\)", " ".join(f"fill: {fill}" for fill in look)) for look in looks]
        self.assertEqual([bool(hatch) for hatch in hatches], [n >= 8 for n in range(18)])
        ids = {element.get("id") for element in bars.iter()}
        for hatch in filter(None, hatches):
            self.assertIn(hatch[1], ids)
        self.assertEqual(len({(plot.style(n)["color"], plot.style(n)["marker"]) for n in range(32)}), 32)

    def test_round_places_get_ticks_of_their_own_and_measured_ones_do_not(self):
        threads = texts(drawn(figure(panel({"": [point(x, x) for x in (1, 2, 4, 64)]}), log_x=True)))
        for place in ("1", "2", "4", "64"):
            self.assertIn(place, threads)
        measured = (2.49885925, 3.2795525, 5.25669075)
        for text in texts(drawn(figure(panel({"": [point(x, x) for x in measured]}), log_x=True))):
            self.assertLessEqual(len(text), 6)
        wide = texts(drawn(figure(panel({"": [point(x, 100 * x, reach=10000) for x in (1, 2, 4)]}), log_x=True)))
        self.assertNotIn("2", wide, "whiskers leave no room for it")

    def test_a_single_place_is_the_only_tick(self):
        for log_x in (False, True):
            words = texts(drawn(figure(panel({"": [point(37, 0.5), point(37, 0.6)]}), log_x=log_x)))
            self.assertEqual([text for text in words if text.isdigit() and text != "0"], ["37"])

    def test_errors_start_at_zero_and_similarities_where_they_differ(self):
        values = {"": [point(x, 0.9825 + 0.004 * x) for x in range(4)]}
        self.assertIn("0", texts(drawn(figure(panel(values), x_name="")))[4:])
        lowest = min(float(text) for text in texts(drawn(figure(panel(values, more_is_better=True)))) if text.startswith("0."))
        self.assertGreater(lowest, 0.97)

    def test_colours_of_the_page_are_variables_and_ids_its_own(self):
        what = figure(panel({"a": [point(1, 1), point(2, 2)], "b": [point(1, 2), point(2, 1)]}))
        svg = plot.for_page(plot.to_svg(what.plot()), what, "f7")
        for colour in plot.VARIABLES:
            self.assertNotIn(colour, svg)
        self.assertIn("var(--s1)", svg)
        self.assertTrue(all(name.startswith("f7-") for name in re.findall(r' id="([^"]*)"', svg)))
        self.assertEqual(len(re.findall("<title>", svg)), 4)


class Files(FolderCase):
    def test_a_figure_is_saved_as_svg_pdf_and_csv_and_equal_figures_give_equal_bytes(self):
        what = figure(panel({"a": [point(1, 1), point(2, 2)]}))
        for name in ("one", "two"):
            what.save(self.folder / name)
        for suffix, start in ((".svg", b"<?xml"), (".pdf", b"%PDF"), (".csv", b"panel,unit,curve,x,")):
            content = (self.folder / f"one{suffix}").read_bytes()
            self.assertTrue(content.startswith(start))
            self.assertEqual(content, (self.folder / f"two{suffix}").read_bytes())
        self.assertNotIn(b"var(--", (self.folder / "one.svg").read_bytes())
        self.assertEqual(len(what.table), 2)


if __name__ == "__main__":
    unittest.main()
