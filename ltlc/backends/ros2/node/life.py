"""The node from start to end: arguments, signals, the loop, the exit code."""

from __future__ import annotations

import argparse
import gc
import sys
import threading
import time
import traceback
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from signal import SIG_UNBLOCK, SIGINT, SIGTERM, pthread_sigmask
from signal import signal as on_signal
from typing import Any

import rclpy
from rclpy.exceptions import ParameterException
from rclpy.executors import Executor, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import remove_ros_args, try_shutdown

from ltlc.backends.ros2.node.files import UnusableError
from ltlc.backends.ros2.node.options import read_options
from ltlc.backends.ros2.node.topics import GuardedTopic, Topic
from ltlc.backends.ros2.node.watch import LetIn, Watch
from ltlc.backends.ros2.node.watchdog import UNUSABLE, Pulse
from ltlc.runtime.session import Plan

ALLOCATIONS = 10_000
"""So many objects more than were freed are searched for garbage, not 700.

A node makes little of it. Of what each of 100,000 ids needs to be judged, none is any,
and searching all that again and again took longer than judging it.
"""


def run_node(
    pulse: Pulse,
    name: str,
    plan: Plan,
    topics: Sequence[Topic],
    guarded: Sequence[GuardedTopic],
    provenance: Mapping[str, Any],
    about: str,
    import_ros: Callable[[], None],
) -> int:
    """Monitor until a signal, the timeout or a violation ends it; the exit code.

    `pulse` shows the watchdog that the node lives; `provenance` is part of what it
    reports.

    rclpy's own signal handlers would shut down the context, and with it the way to
    publish the final verdicts: SIGINT and SIGTERM only ask the loop to end. They may
    come early: to import ROS takes most of the time that the node needs to start.
    """
    stop = threading.Event()
    for number in (SIGINT, SIGTERM):
        on_signal(number, lambda *_: stop.set())
    pthread_sigmask(SIG_UNBLOCK, (SIGINT, SIGTERM))
    try:
        import_ros()
    except Exception as error:  # noqa: BLE001
        print(
            f"ROS 2 is not available: {error}; source its setup file", file=sys.stderr
        )
        return UNUSABLE
    try:
        parse_arguments(about)
        rclpy.init(args=sys.argv, signal_handler_options=SignalHandlerOptions.NO)
        node = Node(name, automatically_declare_parameters_from_overrides=True)
        options = read_options(node, plan)
        watch = Watch(node, plan, topics, guarded, options, provenance, pulse)
        code = watched(stop, node, watch)
        node.destroy_node()  # else the middleware leaves files in /dev/shm
        return code
    except (UnusableError, ParameterException, RuntimeError) as error:
        print(f"{name}: {error}", file=sys.stderr)
        return UNUSABLE
    except Exception:  # noqa: BLE001
        print(f"{name}: {traceback.format_exc()}", file=sys.stderr)
        return UNUSABLE
    finally:
        try_shutdown()


def parse_arguments(about: str) -> None:
    """Answer `--help`, and refuse what is neither that nor meant for ROS."""
    parser = argparse.ArgumentParser(
        description=about, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.parse_args(remove_ros_args(sys.argv)[1:])


def watched(stop: threading.Event, node: Node, watch: Watch) -> int:
    """Watch until it ends or breaks, and report the verdicts; the exit code."""
    gc.freeze()
    gc.set_threshold(ALLOCATIONS)
    try:
        watch_until(stop, node, watch)
    except UnusableError as error:
        print(f"{node.get_name()}: {error}", file=sys.stderr)
        return UNUSABLE
    except Exception:  # noqa: BLE001
        watch.fail(traceback.format_exc())
    return watch.end()


def watch_until(stop: threading.Event, node: Node, watch: Watch) -> None:
    """Let messages come in until `stop` is set or `watch` has ended."""
    executor = fastest_executor()
    executor.add_node(node)
    let_in = partial(let_in_what_came, executor, watch)
    while not stop.is_set() and not watch.has_ended:
        executor.spin_once(timeout_sec=watch.patience())
        watch.attend(let_in)
    if not watch.has_ended:
        end_with_what_came(watch, let_in)
    watch.keep_house()


def fastest_executor() -> Executor:
    """The events executor where rclpy has it: it needs half the time for a message."""
    try:
        from rclpy.experimental import EventsExecutor
    except ImportError:
        return SingleThreadedExecutor()
    return EventsExecutor()


def let_in_what_came(executor: Executor, watch: Watch, looks: int) -> bool:
    """Let in what has been received, if that is no more than can wait.

    It is all when so many `looks` in a row have found nothing: one may have found
    something other than a message.
    """
    idle, most = 0, watch.messages + watch.most_waiting
    while idle < looks:
        before = watch.messages
        if before >= most:
            return False
        executor.spin_once(timeout_sec=0.0)
        idle = idle + 1 if watch.messages == before else 0
    return True


def end_with_what_came(watch: Watch, let_in: LetIn) -> None:
    """Judge those messages that had been received when the signal came.

    launch waits 5 s for a node to end before it sends the next signal.
    """
    deadline = time.monotonic() + 3.0
    watch.hurry()
    while not watch.catch_up(let_in):
        if time.monotonic() > deadline:
            watch.leave_the_rest()
            return
