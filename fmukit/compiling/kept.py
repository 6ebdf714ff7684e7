"""What a compiler has made of some sources, kept in the user's cache under both."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from hashlib import blake2b
from pathlib import Path

from fmukit import store
from fmukit.compiling import compiler
from fmukit.errors import BuildError


def kept(
    what: str,
    sources: Iterable[str],
    name: str,
    make: Callable[[], bytes],
    platforms: Sequence[str] | None = None,
    root: Path | None = None,
) -> Path:
    """The file `name` that `make()` compiles from `sources` for `platforms` (default: this one), out of the cache.

    Without a compiler it is what any compiler has made of the same sources. Raises BuildError when there is nothing.
    """
    folder = f"{what}-{_key(sources)}"
    try:
        compilers = _key(compiler.identity(platform) for platform in platforms or (compiler.host_platform(),))
    except BuildError:
        found = store.found(f"{folder}.*", name, root)
        if found is None:
            raise
        return found
    return store.kept(f"{folder}.{compilers}", name, make, root)


def _key(parts: Iterable[str]) -> str:
    digest = blake2b(digest_size=8)
    for part in parts:
        digest.update(f"{len(part)}\n{part}".encode())
    return digest.hexdigest()
