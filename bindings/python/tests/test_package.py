"""The stubs say what the built module has; the examples and the listing of the README run."""

import ast
import inspect
import re
import subprocess
import sys
from pathlib import Path

import pytest

import headland
from headland import _core

BINDINGS = Path(__file__).resolve().parents[1]


def members(cls):
    return {name for name in vars(cls) if not name.startswith("__") or name in ("__getitem__", "__setitem__")}


def test_stubs():
    tree = ast.parse((Path(headland.__file__).parent / "_core.pyi").read_text())
    classes = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
    assert set(classes) == {name for name, value in vars(_core).items() if inspect.isclass(value)}
    for name, node in classes.items():
        cls = getattr(_core, name)
        stubs = {f.name: f for f in node.body if isinstance(f, ast.FunctionDef)}
        assert {s for s in stubs if s not in ("__copy__", "__deepcopy__")} == members(cls) - {"__copy__", "__deepcopy__"}
        for method, stub in stubs.items():
            value = inspect.getattr_static(cls, method)
            if any(isinstance(d, ast.Name) and d.id == "property" for d in stub.decorator_list):
                assert inspect.isgetsetdescriptor(value), f"{name}.{method}"
                continue
            if method.startswith("__"):
                continue
            a = stub.args
            wanted = [arg.arg for arg in a.posonlyargs + a.args + a.kwonlyargs if arg.arg != "self"]
            found = [p for p in inspect.signature(getattr(cls, method)).parameters if p != "self"]
            assert wanted == found, f"{name}.{method}"
            assert ast.get_docstring(stub), f"{name}.{method} has no doc"


def test_all_is_there():
    assert all(hasattr(headland, name) for name in headland.__all__)
    assert (Path(headland.__file__).parent / "py.typed").exists()
    assert headland.__version__ == re.search(r'^version = "(.*)"', (BINDINGS / "Cargo.toml").read_text(), re.M)[1]
    for error in headland.SceneError, headland.DeriveError, headland.SolveError, headland.RunError:
        assert issubclass(error, headland.Error)


@pytest.mark.parametrize("example", sorted((BINDINGS / "examples").glob("*.py")), ids=lambda path: path.stem)
def test_examples(example):
    done = subprocess.run([sys.executable, str(example)], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0 and done.stdout and not done.stderr, done.stderr


@pytest.mark.parametrize("readme", ["README.md", "bindings/python/README.md"])
def test_listings(root, readme, monkeypatch, capsys):
    monkeypatch.chdir(root)
    listings = re.findall(r"```python\n(.*?)```", (root / readme).read_text(), re.S)
    assert listings
    for listing in listings:
        exec(listing, {})
        assert capsys.readouterr().out
