"""Dask does the spreading: on the cores of this computer, or on a cluster that is there."""

import contextlib
import logging
import os
import queue
import signal
import sys
import tempfile
import threading
import uuid

from . import job

RETRIES = 2  # of what could not be done there; of workers that die the scheduler's own limit counts
CONNECT_S = 10
END_S = 20  # that what was cancelled has until it has to have ended
KILLED = 137


class Unusable(Exception):
    """There is nothing to compute on; said in one line."""


class Interrupt:
    """From now on the first Ctrl-C ends nothing by itself; the second does."""

    def __init__(self):
        self.came = False
        signal.signal(signal.SIGINT, self.note)

    def note(self, _number, _frame):
        self.came = True
        signal.signal(signal.SIGINT, signal.SIG_DFL)


def dask():
    try:
        import cloudpickle  # pylint: disable=import-outside-toplevel
        import distributed  # pylint: disable=import-outside-toplevel
    except ImportError as error:
        raise Unusable(f"needs the Debian package python3-distributed ({error})") from error
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    # Workers elsewhere have Dask, but not this package's scripts. Ubuntu 20.04's cannot be sent them.
    if hasattr(cloudpickle, "register_pickle_by_value"):
        cloudpickle.register_pickle_by_value(job)
    return distributed


def cores():
    return len(os.sched_getaffinity(0))


@contextlib.contextmanager
def without_interrupt():
    """Processes that begin within it are not ended by Ctrl-C on the terminal, but by whoever began them."""
    handler = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, handler)


@contextlib.contextmanager
def connected(scheduler, jobs):
    """@param scheduler address, or None for this computer. @param jobs of this computer's processes at a time.
    @raises Unusable"""
    distributed = dask()
    with contextlib.ExitStack() as stack:
        if scheduler is None:
            folder = stack.enter_context(tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
                                         if sys.version_info >= (3, 10) else tempfile.TemporaryDirectory())
            with without_interrupt():
                cluster = stack.enter_context(distributed.LocalCluster(
                    n_workers=jobs, threads_per_worker=1, processes=True, dashboard_address=None,
                    local_directory=folder, silence_logs=logging.CRITICAL))
            scheduler = cluster.scheduler_address
        try:
            comm = distributed.comm
            comm.resolve_address(comm.normalize_address(scheduler))  # else a client is left half made
            client = distributed.Client(scheduler, timeout=CONNECT_S, set_as_default=False)
        except (OSError, ValueError, TypeError) as error:
            raise Unusable(f"no Dask scheduler answers at {scheduler}: {str(error).splitlines()[0]}") from error
        yield stack.enter_context(client)


def result_of(future):
    """@return what job.run() returns, whatever happened to it."""
    from distributed.scheduler import KilledWorker  # pylint: disable=import-outside-toplevel
    if future.status in ("cancelled", "lost"):
        return job.not_run("not done: the connection to the scheduler was lost")
    try:
        return future.result()
    except KilledWorker:
        return job.not_run("each worker that it was given to died", KILLED)
    except Exception as error:  # pylint: disable=broad-except
        return job.not_run(f"not done: {type(error).__name__}: {error}".splitlines()[0])


class Running:
    """What runs, as the workers tell."""

    def __init__(self, show):
        self.show, self.names, self.changed = show, set(), threading.Condition()

    def note(self, event):
        name, runs = event[1]
        with self.changed:
            if runs:
                self.names.add(name)
            else:
                self.names.discard(name)
            self.changed.notify_all()
        if runs:
            self.show.begins(name)

    def wait_for_none(self):
        with self.changed:
            self.changed.wait_for(lambda: not self.names, END_S)


def results(client, work, show, interrupt):
    """Yields each job's name and result, in the order in which they end. Ends early after Ctrl-C; what still runs is
    ended then.
    @param work jobs. @param show what is told of each that begins: show.begins(name)"""
    topic = f"{job.PACKAGE}-{uuid.uuid4()}"
    done, names, futures, running = queue.Queue(), {}, [], Running(show)
    if hasattr(client, "subscribe_topic"):
        client.subscribe_topic(topic, running.note)
    for number, one in enumerate(work):
        future = client.submit(job.run, one, topic, key=f"{topic}-{number}", pure=False, retries=RETRIES)
        names[future.key] = one["name"]
        futures.append(future)
        future.add_done_callback(done.put)
    if not client.scheduler_info()["workers"]:
        show.note("the scheduler has no worker yet; waiting for one")
    try:
        left = len(work)
        while left and not interrupt.came:
            try:
                future = done.get(timeout=0.2)
            except queue.Empty:
                continue
            left -= 1
            futures.remove(future)
            name, result = names[future.key], result_of(future)
            future = None  # a result that nobody holds is not computed again where its worker dies
            yield name, result
    finally:
        if futures:
            client.cancel(futures, force=True)
            running.wait_for_none()
