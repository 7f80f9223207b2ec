"""Workers on other machines, or on this one, through Dask."""

from __future__ import annotations

import logging
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from itertools import islice
from typing import Any

from ltlc import __version__
from ltlc.base.codes import diagnostic
from ltlc.base.diagnostics import Diagnostic
from ltlc.base.libraries import command
from ltlc.base.source import Source
from ltlc.monitoring.campaigns.campaign import Failure, Workers, judge_beside_others
from ltlc.monitoring.campaigns.outcomes import Outcome
from ltlc.monitoring.campaigns.places import Location
from ltlc.monitoring.judging.run import Judge

SECONDS = 15.0
"""How long the scheduler has to answer, and then the first worker to be there."""

AHEAD = 4
"""How many recordings are with the engine for each worker."""

_SETTINGS = {
    "distributed.scheduler.allowed-failures": 0,  # a recording that ends its worker is tried again by ourselves
    "distributed.worker.profile.enabled": False,
    "distributed.comm.timeouts.connect": SECONDS,
}


class EngineError(Exception):
    """There are no workers, for the reason that `diagnostic` gives."""

    def __init__(self, address: str, message: str, help: str = "") -> None:
        super().__init__(message)
        self.diagnostic: Diagnostic = diagnostic("LTL834", Source(address, ""), None, message, help=help)


@contextmanager
def on_engine(address: str, jobs: int | None) -> Iterator[Workers]:
    """Workers of the Dask scheduler at `address`; `local` starts one here, with as many workers as `jobs`.

    Raises EngineError. What was started here is ended.
    """
    try:
        import dask
        from distributed import Client, LocalCluster
    except ImportError:
        message = "`--engine` needs Dask, which is not installed"
        raise EngineError(address, message, command("campaigns")) from None
    for name in [each for each in logging.root.manager.loggerDict if each.startswith("distributed")]:
        logging.getLogger(name).setLevel(logging.CRITICAL)  # we report what is lost ourselves
    with dask.config.set(_SETTINGS), ExitStack() as started:
        try:
            to = address
            if address == "local":
                to = started.enter_context(LocalCluster(n_workers=jobs, threads_per_worker=1, dashboard_address=None))
            client = started.enter_context(Client(to, timeout=SECONDS, set_as_default=False))
            client.wait_for_workers(1, timeout=SECONDS)
        except (OSError, TimeoutError, ValueError, ImportError) as error:
            message = f"no workers at `{address}`: {error or type(error).__name__}"
            raise EngineError(address, message, "start them with `dask scheduler` and `dask worker`") from None
        _refuse_other_versions(address, client)

        def work(judge: Judge, places: Sequence[Location]) -> Iterator[tuple[int, Outcome | Failure]]:
            try:
                yield from _judged(client, judge, places)
            except (OSError, TimeoutError, RuntimeError) as error:
                message = f"no workers left at `{address}`: {error or type(error).__name__}"
                raise EngineError(address, message, "with `--results`, the same command continues from here") from None

        yield work


def _refuse_other_versions(address: str, client: Any) -> None:
    try:
        versions = set(client.run(_version).values())
    except Exception as error:  # whatever a worker without ltlc says
        message = f"the workers at `{address}` cannot run ltlc: {error}"
        raise EngineError(address, message, "install ltlc where they run, in their environment") from None
    if versions != {__version__}:
        told = ", ".join(sorted(versions))
        message = f"the workers at `{address}` have ltlc {told}, this machine has {__version__}"
        raise EngineError(address, message, "install the same version in both places")


def _version() -> str:
    """The version of ltlc where this is called."""
    return __version__


def _judged(client: Any, judge: Judge, places: Sequence[Location]) -> Iterator[tuple[int, Outcome | Failure]]:
    """The outcomes of the recordings, as they come; work in progress is cancelled if the consumer stops.

    So many are under way that no worker waits; what takes all workers down does not take the others with it.
    """
    from distributed import as_completed

    client.wait_for_workers(1, timeout=SECONDS)
    ahead = AHEAD * sum(client.nthreads().values())
    waiting = iter(enumerate(places))
    running: dict[Any, int] = {}
    arriving = as_completed(loop=client.loop, raise_errors=False, with_results=True)
    shared = client.scatter(judge, broadcast=True, hash=False)

    def submit(count: int) -> None:
        for number, place in islice(waiting, count):
            future = client.submit(judge_beside_others, shared, place, pure=False)
            running[future] = number
            arriving.add(future)

    try:
        submit(ahead)
        while running:
            future, found = next(arriving)
            is_done = future.status == "finished"
            if not is_done and shared.status != "finished":
                shared = client.scatter(judge, broadcast=True, hash=False)
            number = running.pop(future)
            submit(1)
            yield number, found if is_done else Failure("its worker was lost")
    finally:
        client.cancel(list(running))
