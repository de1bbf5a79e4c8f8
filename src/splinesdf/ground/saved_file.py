"""Open a saved file, whatever its name may turn out to be."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from splinesdf.errors import InputError
from splinesdf.ground.paths import as_path, shortened


@contextmanager
def saved_file(path: Path) -> Iterator[BinaryIO]:
    """The file, open for reading; what goes wrong on the way is one `InputError`."""
    name = shortened(str(as_path(path)))
    try:
        if path.exists() and not path.is_file() and not path.is_dir():
            # A pipe would be waited for, a device might never end.
            raise InputError(f"expected a saved fit, but {name!r} is not a regular file")
        with path.open("rb") as file:
            yield file
    except InputError:
        raise
    except FileNotFoundError as error:
        raise InputError(f"expected a saved fit, but {name!r} does not exist") from error
    except IsADirectoryError as error:
        raise InputError(f"expected a saved fit, got the folder {name!r}") from error
    except MemoryError as error:
        raise InputError(f"cannot read {name!r}: not enough memory") from error
    except OSError as error:
        raise InputError(f"cannot read {name!r}: {error.strerror or error}") from error
    except ValueError as error:  # a name with a null character
        raise InputError(f"cannot read {name!r}: {error}") from error
