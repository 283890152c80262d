"""Files that are written completely or not at all."""

import os
import tempfile


def write_all(contents):
    """Writes files, {path: bytes}, aside and renames them when all are complete: after an error none has changed. A path that
    is not a regular file (a pipe) is written to directly, and a symbolic link is followed. Raises OSError whose filename is
    the path."""
    complete = {}
    try:
        for path, content in contents.items():
            if path.exists() and not path.is_file():
                path.write_bytes(content)
            else:
                complete[path] = write_aside(path.resolve(), content)
        for path in list(complete):
            os.replace(complete[path], path.resolve())
            del complete[path]
    except OSError as error:
        error.filename = str(path)
        raise
    finally:
        for temporary in complete.values():
            os.unlink(temporary)


def write_aside(target, content):
    """The name of a complete temporary beside target, with its permissions."""
    descriptor, temporary = tempfile.mkstemp(prefix=f".{target.name}.", dir=target.parent)
    try:
        with open(descriptor, "wb", buffering=0):
            written = 0
            while written < len(content):
                written += os.pwrite(descriptor, content[written:written + 2**20], written)
            os.umask(umask := os.umask(0))
            os.fchmod(descriptor, target.stat().st_mode & 0o777 if target.exists() else 0o666 & ~umask)
        return temporary
    except BaseException:
        os.unlink(temporary)
        raise
