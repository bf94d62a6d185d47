"""A disk: what was written is safe when it was synced, and a name when the journal has it."""

import errno
import io

from tests.livesim.world import PowerCut

KEPT = 4  # older versions of a file, for backups that somebody plays back


class Content:
    """What stands in a file: as processes see it, and as it is safe from a power cut."""

    def __init__(self, text=""):
        self.text = text
        self.safe = None


class Disk:
    """Files of one machine.

    Attributes:
        names: what processes see, by path.
        safe_names: the same as the journal has it.
        full: nothing more can be written.
        refused: how often something could not be.
        cut_after: the power goes off at that many operations from now; None = it does not.
        on_cut: is called then.
    """

    def __init__(self, chance):
        self.names = {}
        self.safe_names = {}
        self.full = False
        self.refused = 0
        self.cut_after = None
        self.on_cut = None
        self._chance = chance
        self._older = {}

    def put(self, path, text):
        """A file that a person writes, safely."""
        content = Content(text)
        content.safe = text
        self.names[str(path)] = self.safe_names[str(path)] = content

    def step(self):
        """Another operation; the power may go off before it."""
        if self.cut_after is not None:
            self.cut_after -= 1
            if self.cut_after <= 0:
                self.cut_after = None
                self.on_cut()
                raise PowerCut

    def power_cut(self):
        """A name that the journal had not yet is old or new; what was not synced is torn."""
        for path in sorted(self.names.keys() | self.safe_names.keys()):
            new, old = self.names.get(path), self.safe_names.get(path)
            kept = new if new is old or self._chance.random() < 0.5 else old
            self.names.pop(path, None)
            self.safe_names.pop(path, None)
            if kept is not None:
                text = kept.text
                if kept.safe != text:
                    text = text[: self._chance.randrange(len(text) + 1)]
                self.put(path, text)
        self.cut_after = None

    def lose(self, path):
        """A file is gone, as on a new card."""
        self.names.pop(str(path), None)
        self.safe_names.pop(str(path), None)

    def make_stale(self, path):
        """A file is as it was some time before, as out of a backup."""
        older = self._older.get(str(path))
        if older:
            self.put(path, self._chance.choice(older))

    def refuse(self):
        """There is no room."""
        self.refused += 1
        raise OSError(errno.ENOSPC, "No space left on device")

    def read_text(self, path):
        """What processes see in a file."""
        self.step()
        if str(path) not in self.names:
            raise FileNotFoundError(errno.ENOENT, "No such file or directory", str(path))
        return self.names[str(path)].text

    def create(self, path):
        """A new file, or an old one emptied."""
        self.step()
        if self.full and str(path) not in self.names:
            self.refuse()
        content = self.names[str(path)] = Content()
        return _File(self, content)

    def sync(self, file):
        """What is in the file is safe, and so is its name."""
        self.step()
        file.flush()
        file.content.safe = file.content.text

    def replace(self, old, new):
        """The new name is seen at once; the journal has it when it has it."""
        self.step()
        content = self.names.pop(str(old), None)
        if content is None:
            raise FileNotFoundError(errno.ENOENT, "No such file or directory", str(old))
        before = self.names.get(str(new))
        if before is not None:
            self._older[str(new)] = [*self._older.get(str(new), ()), before.text][-KEPT:]
        self.names[str(new)] = content
        self.safe_names.pop(str(old), None)

    def sync_names(self):
        """The journal has all names."""
        self.step()
        self.safe_names = dict(self.names)

    def remove(self, path):
        """A name is gone, and what it stood for."""
        self.step()
        if str(path) not in self.names:
            raise FileNotFoundError(errno.ENOENT, "No such file or directory", str(path))
        self.lose(path)


class _File(io.StringIO):
    """An open file; what is written goes to the disk when it is flushed or closed."""

    def __init__(self, disk, content):
        super().__init__()
        self.disk, self.content = disk, content

    def flush(self):
        if self.closed or self.getvalue() == self.content.text:
            return
        if self.disk.full:
            self.disk.refuse()
        self.content.text = self.getvalue()

    def close(self):
        if not self.closed:
            try:
                self.flush()
            finally:
                super().close()
