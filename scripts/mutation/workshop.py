"""A copy of the sources, and a build of it, in which one rule at a time is broken and put right again."""

import contextlib
import os
import pathlib
import shutil
import subprocess

from mutation.entries import Wrong

# What links a shared library need not be linked again when it changes.
OPTIONS = ("-DCMAKE_LINK_DEPENDS_NO_SHARED=ON", "-DTCCM_MONITOR_BENCHMARKS=OFF")


def sources_of(repository):
    """@return paths from it on: what git knows, and what is new; of an archive all but builds."""
    listed = subprocess.run(["git", "-C", repository, "ls-files", "-coz", "--exclude-standard"],
                            capture_output=True, check=False)
    if listed.returncode == 0:
        names = [os.fsdecode(name) for name in listed.stdout.split(b"\0") if name]
    else:
        names = [str(path.relative_to(repository)) for path in repository.rglob("*")
                 if not path.relative_to(repository).parts[0].startswith(("build", "."))]
    return {name for name in names if (repository / name).is_file()}


def same(one, other):
    """By size and time of change, as make looks at files."""
    if not other.exists():
        return False
    first, second = one.stat(), other.stat()
    return (first.st_size, first.st_mtime_ns) == (second.st_size, second.st_mtime_ns)


def files_of(folder):
    for where, _folders, names in os.walk(folder):
        for name in names:
            path = pathlib.Path(where, name)
            if path.is_file() and not path.is_symlink():
                yield path


class Workshop:
    """In a folder of its own: source/, build/, and kept/, the build as it was made of sources that are whole."""

    def __init__(self, repository, folder, jobs):
        self.repository, self.folder, self.jobs = repository, folder, jobs
        self.source, self.build, self.kept = folder / "source", folder / "build", folder / "kept"
        self.log = folder / "build.log"

    def update(self):
        """The copy becomes as the repository is. What is the same keeps its time of change."""
        self.source.mkdir(parents=True, exist_ok=True)
        names = sources_of(self.repository)
        for name in names:
            text, copy = (self.repository / name).read_bytes(), self.source / name
            if not copy.exists() or copy.read_bytes() != text:
                copy.parent.mkdir(parents=True, exist_ok=True)
                copy.write_bytes(text)
            shutil.copymode(self.repository / name, copy)
        for path in list(files_of(self.source)):
            if str(path.relative_to(self.source)) not in names and not self.is_build(path):
                path.unlink()

    def is_build(self, path):
        return path.relative_to(self.source).parts[0].startswith(("build", ".git"))

    def configure(self):
        """As scripts/build does, or others' options."""
        if (self.build / "Makefile").exists():
            return self.run(["make", "--no-print-directory", "-C", self.build, "cmake_check_build_system"])
        launcher = shutil.which("ccache")
        options = [f"-DCMAKE_CXX_COMPILER_LAUNCHER={launcher}"] if launcher else []
        data = self.repository.parent / "shared" / "data"
        options += [f"-DTCCM_SHARED_DATA_DIR={data}"] if data.is_dir() else []
        return self.run(["cmake", "-S", self.source, "-B", self.build, "-G", "Unix Makefiles", *OPTIONS, *options])

    def make(self, targets):
        return self.run(["make", "--no-print-directory", "-C", self.build, f"-j{self.jobs}", *sorted(set(targets))])

    def run(self, command):
        """@return whether it did; what it said is in the log."""
        with open(self.log, "wb") as log:
            # Not ended by Ctrl-C: a build that was would look like one that fails.
            return subprocess.run(command, stdout=log, stderr=subprocess.STDOUT, check=False,
                                  start_new_session=True).returncode == 0

    def complaint(self):
        lines = self.log.read_text(encoding="utf-8", errors="replace").splitlines()
        errors = [line for line in lines if "error:" in line] or lines[-1:]
        return errors[0].strip() if errors else "it said nothing"

    def begin(self):
        """@raises Wrong where the sources as they are cannot be configured."""
        self.folder.mkdir(parents=True, exist_ok=True)
        self.update()
        if not self.configure():
            raise Wrong(f"the copy cannot be configured: {self.complaint()}; see {self.log}")

    def keep(self, targets):
        """Builds them of sources that are whole. @raises Wrong"""
        if not self.make(targets):
            raise Wrong(f"the copy cannot be built: {self.complaint()}; see {self.log}")
        for path in files_of(self.build):
            copy = self.kept / path.relative_to(self.build)
            if not same(path, copy):
                copy.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(path, copy)

    @contextlib.contextmanager
    def broken_by(self, mutation):
        path = self.source / mutation.file
        text, times = path.read_text(encoding="utf-8"), path.stat()
        try:
            path.write_text(text.replace(mutation.before, mutation.after), encoding="utf-8")
            yield
        finally:
            self.put_back()
            # Last: where this is interrupted, what is still broken is copied anew, and built.
            path.write_text(text, encoding="utf-8")
            os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))

    def put_back(self):
        """What was built of broken sources; with its time, so that make need not build it again."""
        for path in list(files_of(self.build)):
            copy = self.kept / path.relative_to(self.build)
            if not copy.exists():
                path.unlink()
            elif not same(path, copy):
                shutil.copy2(copy, path)
