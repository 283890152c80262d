"""The stub names exactly what the module has, and the docstrings say what they must."""

import ast
import inspect
import re

import lodestone
import lodestone._lodestone as module
import pytest
from conftest import SOURCE

STUB = ast.parse((SOURCE / "python/lodestone/_lodestone.pyi").read_text())
FUNCTIONS = {node.name: node for node in STUB.body if isinstance(node, ast.FunctionDef)}
CLASSES = {node.name: node for node in STUB.body if isinstance(node, ast.ClassDef)}
METHODS = {(c, node.name): node for c, body in CLASSES.items() for node in body.body
           if isinstance(node, ast.FunctionDef) and not node.decorator_list and not node.name.startswith("__")}
PROPERTIES = {c: {node.name for node in body.body if isinstance(node, ast.FunctionDef) and node.decorator_list}
              for c, body in CLASSES.items()}


def public(names):
    return {name for name in names if not name.startswith("_")}


def parameters(node):
    """The parameters of a function of a stub as those of a signature line: without types."""
    for argument in [*node.args.args, *node.args.kwonlyargs]:
        argument.annotation = None
    return ast.unparse(node.args).removeprefix("self, ").removeprefix("self")


def signature(doc):
    """Name and parameters of the first paragraph of a docstring, written the same way."""
    name, inner = re.fullmatch(r"(\w+)\((.*)\)", " ".join(doc.split("\n\n")[0].split())).groups()
    return name, ast.unparse(ast.parse(f"def f({inner}): ...").body[0].args)


def test_names():
    assert public(vars(module)) == FUNCTIONS.keys() | CLASSES.keys()
    for name, node in CLASSES.items():
        if issubclass(getattr(module, name), Exception):
            continue
        methods = {method for c, method in METHODS if c == name}
        assert public(vars(getattr(module, name))) == methods | PROPERTIES[name], name
    assert set(lodestone.__all__) == (public(vars(module)) | {"load_sweep", "__version__"})
    assert lodestone.__all__ == sorted(lodestone.__all__, key=lambda name: (name[0] == "_" and "Z_" or name))


@pytest.mark.parametrize("name", FUNCTIONS)
def test_functions_are_as_the_stub_has_them(name):
    assert signature(getattr(module, name).__doc__) == (name, parameters(FUNCTIONS[name]))


@pytest.mark.parametrize("of, name", METHODS)
def test_methods_are_as_the_stub_has_them(of, name):
    assert signature(getattr(getattr(module, of), name).__doc__) == (name, parameters(METHODS[of, name]))


def test_keywords_are_those_of_the_module():
    """An unknown keyword is refused with the list of those that there are."""
    mesh = lodestone.generate("sphere", triangles=2000)
    hierarchy = lodestone.build(mesh)
    camera = lodestone.camera_path(hierarchy, "orbit", frames=1)[0]
    selection = lodestone.select(hierarchy, camera)
    arguments = {"build": [mesh], "progressive": [mesh], "reconstruct": [mesh], "compare": [mesh, mesh], "verify": [hierarchy],
                 "select": [hierarchy, camera], "render": [hierarchy, camera], "fly": [hierarchy, [camera]],
                 "cracks": [selection], "pops": [selection, selection], "generate": ["sphere"], "read": ["x"], "load": ["x"],
                 "camera_path": [hierarchy, "orbit"], "compare_pictures": [[], []], "run_experiment": ["build", {}, "."]}
    options = {name for name, node in FUNCTIONS.items() if node.args.kwonlyargs}
    assert options == arguments.keys()
    for name, given in arguments.items():
        with pytest.raises(lodestone.UsageError) as raised:
            getattr(module, name)(*given, unknown=1)
        known = str(raised.value).split("the options are ")[1].split(", ")
        assert set(known) == {argument.arg for argument in FUNCTIONS[name].args.kwonlyargs}, name


def test_defaults_are_those_of_the_module(tmp_path):
    """Given as the stub has them, they change nothing."""
    sphere = lodestone.generate("sphere", triangles=20000)

    def defaults(name):
        given = FUNCTIONS[name].args
        return {argument.arg: ast.literal_eval(value) for argument, value in zip(given.kwonlyargs, given.kw_defaults)}

    box = lodestone.generate("box", triangles=12)
    # Reconstruction at its usual resolution takes seconds.
    for name, suffix, own in (("build", "lode", {}), ("progressive", "lpm", {}), ("reconstruct", "ply", {"resolution": 24.0})):
        function = getattr(lodestone, name)
        function(sphere, **own).save(tmp_path / f"a.{suffix}")
        function(sphere, **{**defaults(name), **own}).save(tmp_path / f"b.{suffix}")
        assert (tmp_path / f"a.{suffix}").read_bytes() == (tmp_path / f"b.{suffix}").read_bytes(), name
    hierarchy = lodestone.build(sphere)
    camera, = lodestone.camera_path(hierarchy, "fly-in", **{**defaults("camera_path"), "frames": 1})
    given = {key: value for key, value in defaults("render").items() if key != "kappa0"}
    assert (lodestone.render(hierarchy, camera) == lodestone.render(hierarchy, camera, **given)).all()
    assert lodestone.compare(box, sphere) == lodestone.compare(box, sphere, **defaults("compare"))


@pytest.mark.parametrize("name", sorted(FUNCTIONS.keys() | {"load_sweep", "run_experiment"}))
def test_docstrings_of_functions(name):
    function = getattr(lodestone, name)
    text = " ".join(inspect.getdoc(function).split())
    assert re.search(r"\bRaises \w", text), "no word on errors"
    node = FUNCTIONS.get(name)
    said = text + " of select" if name in ("render", "fly") else text  # which refer to it
    for argument in node.args.kwonlyargs if node else []:
        if argument.arg in ("threads", "progress"):  # the package says it
            assert argument.arg in lodestone.__doc__
        elif "of select" not in said:
            assert re.search(rf"\b{argument.arg}\b", text.split(")", 1)[1]), f"nothing on {argument.arg}"


@pytest.mark.parametrize("name", sorted(CLASSES))
def test_docstrings_of_classes(name):
    kind = getattr(lodestone, name)
    assert kind.__doc__ and kind.__module__ in ("lodestone", "lodestone._lodestone")
    for field in PROPERTIES[name]:
        assert field in kind.__doc__, f"nothing on {field}"
    for method in (method for of, method in METHODS if of == name):
        assert getattr(kind, method).__doc__
