"""Which files a component is made of."""

from __future__ import annotations

from hashlib import blake2b
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

from fmukit.component import Component
from fmukit.errors import BuildError

_KINDS = {".py", ".toml", ".c", ".h", ".csv", ".md"}


def component_folder(component: Component) -> Path:
    """The folder of the component's model module, without importing it."""
    spec = find_spec(component.model)
    if spec is None or spec.origin is None:
        raise BuildError(f"the module {component.model} of {component.interface.name} does not exist")
    return Path(spec.origin).parent


def fingerprint(component: Component) -> str:
    """Hash of all sources behind a component: fmukit and the top package of its model, or the model's one file."""
    roots = [Path(__file__).parents[1], *_roots(component)]
    digest = blake2b(digest_size=16)
    for root in roots:
        for path in [root] if root.is_file() else sorted(root.rglob("*")):
            if path.suffix in _KINDS and path.is_file():
                data = path.read_bytes()
                digest.update(f"{path.relative_to(root.parent).as_posix()} {len(data)}\n".encode() + data)
    return digest.hexdigest()


def _roots(component: Component) -> list[Path]:
    top = component.model.partition(".")[0]
    if top == component.model:
        spec = find_spec(top)
        return [Path(spec.origin)] if spec and spec.origin else []
    module = import_module(top)
    return [Path(path) for path in module.__path__]
