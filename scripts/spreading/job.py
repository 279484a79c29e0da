"""One call of a program, wherever it is run. What it wrote is handed back, so that computers share no folder of results.

This file is sent to the workers as it is: it uses nothing of the package.
"""

import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import tempfile

PACKAGE = "tccm_monitor"
NOT_RUN = 2
POLL_S = 0.3
# Ends the program, and what that started, when whoever waits for it is gone. Then nobody else tidies up.
WATCH = """
import os, shutil, signal, subprocess, sys, threading
def watch():
    while os.read(0, 1):
        pass
    os.killpg(program.pid, signal.SIGKILL)
    program.wait()
    shutil.rmtree(sys.argv[1], ignore_errors=True)
    os._exit(128 + signal.SIGKILL)
program = subprocess.Popen(sys.argv[2:], stdin=subprocess.DEVNULL, start_new_session=True)
threading.Thread(target=watch, daemon=True).start()
status = program.wait()
os._exit(status if status >= 0 else 128 - status)
"""


def job(name, program, arguments, inputs, beside):
    """@param inputs (what, path) that have to be readable there. @param beside folders where the program may lie, for
    workers that see what this computer sees."""
    return {"name": name, "program": program, "arguments": arguments, "inputs": inputs,
            "beside": [str(folder) for folder in beside]}


def not_run(error, status=NOT_RUN):
    return {"status": status, "output": "", "error": error, "files": {}, "where": socket.gethostname()}


def program_path(name, beside):
    """@return where it is on this computer, or None."""
    prefixes = [prefix for prefix in os.environ.get("CMAKE_PREFIX_PATH", "").split(":") if prefix]
    folders = beside + [os.path.join(prefix, "lib", PACKAGE) for prefix in prefixes + ["/usr"]]
    paths = [os.environ.get("TCCM_" + name.upper(), "")] + [os.path.join(folder, name) for folder in folders]
    return next((path for path in paths if os.path.isfile(path) and os.access(path, os.X_OK)), None)


def tell(topic, name, runs):
    """Whoever waits for it, that it runs now, or no more."""
    try:
        import distributed  # pylint: disable=import-outside-toplevel
        distributed.get_worker().log_event(topic, [name, runs])
    except (AttributeError, ImportError, ValueError):
        pass  # it shows less, then


def is_cancelled():
    """Nobody waits for it any more."""
    try:
        import distributed  # pylint: disable=import-outside-toplevel
        worker = distributed.get_worker()
        task = worker.state.tasks.get(worker.get_current_task())
        return task is None or task.state == "cancelled"
    except (AttributeError, ImportError, ValueError):
        return False


def finish(process):
    """@return its exit status, as a shell has it."""
    while True:
        try:
            status = process.wait(timeout=POLL_S)
            return status if status >= 0 else 128 - status
        except subprocess.TimeoutExpired:
            if is_cancelled():
                process.stdin.close()
                process.wait()
                return 128 + signal.SIGINT


def run(work, topic):
    """As run_here(). Whoever waits for it is told of its begin and end."""
    tell(topic, work["name"], True)
    try:
        return run_here(work)
    finally:
        tell(topic, work["name"], False)


def run_here(work):
    """The program works in a folder of its own, which is gone with it.
    @return its exit status, standard output and error, and all files that it wrote, by name."""
    program = program_path(work["program"], work["beside"])
    if program is None:
        return not_run(f"the program {work['program']} is not there: set TCCM_{work['program'].upper()} for the worker")
    for what, path in work["inputs"]:
        if not os.access(path, os.R_OK):
            return not_run(f"{what}: cannot be read where it was to be used: {path}")
    scratch = pathlib.Path(tempfile.mkdtemp(prefix=PACKAGE + "_"))
    try:
        folder, out, err = scratch / "files", scratch / "out", scratch / "err"
        folder.mkdir()
        with open(out, "wb") as output, open(err, "wb") as error, subprocess.Popen(
                [sys.executable, "-c", WATCH, scratch, program, *work["arguments"]], cwd=folder, stdin=subprocess.PIPE,
                stdout=output, stderr=error, start_new_session=True) as process:
            status = finish(process)
        files = {path.name: path.read_bytes() for path in folder.iterdir()}
        texts = [path.read_bytes().decode("utf-8", "replace") for path in (out, err)]
        return {"status": status, "output": texts[0], "error": texts[1], "files": files,
                "where": socket.gethostname()}
    finally:
        shutil.rmtree(scratch, ignore_errors=True)
