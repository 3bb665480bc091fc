"""Documentation: complete, and true."""

import doctest
import importlib
import inspect
import pkgutil
import re
import textwrap
from collections.abc import Iterator
from operator import attrgetter
from pathlib import Path
from typing import Any

import pytest
from numpydoc.validate import validate

import zeroset
import zeroset.dask

ROOT = Path(__file__).parents[2]

# Of numpydoc's rules: no docstring, or sections or descriptions that are missing or name something else.
RULES = {"GL08", "SS01", "PR01", "PR02", "PR03", "PR04", "PR07", "RT01", "RT03", "YD01"}


def public() -> Iterator[tuple[str, Any]]:
    """All public functions and classes, with the public members of classes."""
    for name in [*zeroset.__all__, *(f"dask.{name}" for name in zeroset.dask.__all__)]:
        thing = attrgetter(name)(zeroset)
        yield f"zeroset.{name}", thing
        if inspect.isclass(thing):
            for member, value in vars(thing).items():
                if issubclass(thing, tuple):
                    continue
                own = inspect.isroutine(value) or isinstance(value, (property, classmethod)) or hasattr(value, "func")
                if own and (not member.startswith("_") or member in {"__call__", "__or__", "__and__", "__sub__", "__invert__"}):
                    yield f"zeroset.{name}.{member}", value


# What the package makes and users only read: fields are told under Attributes.
RECORDS = {"Cloud", "Plane", "Edge", "Corner", "Newe", "Volume", "Change", "Tile", "Tiles"}


@pytest.mark.parametrize("name", [name for name, _ in public()])
def test_it_is_documented(name: str) -> None:
    found: dict[str, Any] = validate(name)
    rules = {"GL08", "SS01"} if RECORDS & set(name.split(".")) else RULES
    wrong = [f"{code}: {text}" for code, text in found["errors"] if code in rules]
    assert not wrong, wrong


@pytest.mark.parametrize(("name", "thing"), list(public()), ids=[name for name, _ in public()])
def test_it_is_typed(name: str, thing: Any) -> None:
    thing = getattr(thing, "fget", None) or getattr(thing, "func", None) or getattr(thing, "__func__", None) or thing
    if inspect.isclass(thing):
        thing = thing.__init__
    if not inspect.isfunction(thing) or thing.__module__.split(".")[0] != "zeroset":
        return
    signature = inspect.signature(thing)
    given = [p for p in signature.parameters.values() if p.name not in {"self", "cls"}]
    assert all(p.annotation is not p.empty for p in given), f"{name}: a parameter without a type"
    assert signature.return_annotation is not signature.empty, f"{name}: no type of the result"


def test_only_data_go_without_a_name() -> None:
    # What is told by its place: data and positions. Everything else has its name at the call.
    for name in ("reconstruct", "fit", "features", "sample"):
        kinds = [p.kind for p in inspect.signature(getattr(zeroset, name)).parameters.values()]
        assert all(kind is inspect.Parameter.KEYWORD_ONLY for kind in kinds[1:]), name


@pytest.mark.parametrize("module", [module.name for module in pkgutil.iter_modules(zeroset.__path__)] + [""])
def test_examples_in_docstrings(module: str) -> None:
    if module in {"__main__", "_core"}:
        return
    found = importlib.import_module(f"zeroset.{module}" if module else "zeroset")
    assert doctest.testmod(found).failed == 0


def blocks(path: Path) -> list[str]:
    """The Python in a document."""
    return [textwrap.dedent(block) for block in re.findall(r"```python\n(.*?)```", path.read_text(encoding="utf-8"), re.S)]


@pytest.mark.parametrize("document", ["docs/python.md", "README.md"])
def test_examples_in_documents(document: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    # As a script, which starts workers.
    names: dict[str, Any] = {"__name__": "__main__"}
    found = blocks(ROOT / document)
    assert found
    for block in found:
        exec(compile(block, document, "exec"), names)
