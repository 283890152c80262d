"""What the tests of the package share: the command, and models that it made."""

import json
import os
import pathlib
import subprocess

import lodestone
import pytest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SCAN = SOURCE / "examples/models/textured/Gutenberg/Gutenberg.obj"


def run(*arguments):
    subprocess.run([os.environ["LODESTONE_PROGRAM"], *map(str, arguments)], check=True, capture_output=True, timeout=120)


@pytest.fixture
def command(tmp_path):
    """Runs a subcommand and returns what it writes under --json."""
    def call(*arguments):
        run(*arguments, "--json", tmp_path / "result.json")
        return json.loads((tmp_path / "result.json").read_text())
    return call


@pytest.fixture(scope="session")
def sphere_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("models") / "sphere.ply"
    run("generate", "sphere", "--triangles", 12000, "-o", path)
    return path


@pytest.fixture(scope="session")
def hierarchy(sphere_file):
    return lodestone.build(sphere_file, cell_triangles=250)
