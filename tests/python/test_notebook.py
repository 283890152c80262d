"""The blocks of docs/notebook.md run in order, and draw what the page shows."""

import re

import pytest
from conftest import SOURCE

pytest.importorskip("matplotlib").use("Agg")
PAGE = (SOURCE / "docs/notebook.md").read_text()


def test_the_page_runs(tmp_path, monkeypatch):
    (tmp_path / "examples").symlink_to(SOURCE / "examples")
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    assert len(blocks) == 4 and sum(len(block.splitlines()) for block in blocks[:3]) <= 35
    space = {}
    for block in blocks:
        exec(compile(block, "docs/notebook.md", "exec"), space)
    assert (tmp_path / "notebook.png").stat().st_size > 10000
    assert space["triangles"] == sorted(space["triangles"], reverse=True)
    # A tolerance of a pixel cannot be seen, one of 32 can.
    assert space["flip"][0] < 0.001 < 0.01 < space["flip"][-1]


def test_the_page_shows_its_picture():
    assert "images/notebook.png" in PAGE
    assert (SOURCE / "docs/images/notebook.png").read_bytes().startswith(b"\x89PNG")
