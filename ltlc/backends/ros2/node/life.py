"""The node from start to end: arguments, signals, the loop, the exit code."""

from __future__ import annotations

import argparse
import sys
import threading
import time
from collections.abc import Sequence
from signal import SIGINT, SIGTERM
from signal import signal as on_signal

import rclpy
from rclpy.exceptions import ParameterException
from rclpy.executors import Executor, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import remove_ros_args, try_shutdown

from ltlc.backends.ros2.node.intake import Topic
from ltlc.backends.ros2.node.options import UnusableError, read_options
from ltlc.backends.ros2.node.watch import Watch
from ltlc.runtime.session import Plan

UNUSABLE = 2
"""The exit code for parameters or an installation that the node cannot run with."""

LONGEST_WAIT = 0.1
"""How long, in s, the loop waits for a message before it looks at the clock."""


def run_node(name: str, plan: Plan, topics: Sequence[Topic], about: str) -> int:
    """Monitor until a signal, the timeout or a violation ends it; the exit code.

    rclpy's own signal handlers would shut down the context, and with it the way to
    publish the final verdicts: SIGINT and SIGTERM only ask the loop to end.
    """
    stop = threading.Event()
    for number in (SIGINT, SIGTERM):
        on_signal(number, lambda *_: stop.set())
    try:
        parse_arguments(about)
        rclpy.init(args=sys.argv, signal_handler_options=SignalHandlerOptions.NO)
        node = Node(name, automatically_declare_parameters_from_overrides=True)
        watch = Watch(node, plan, topics, read_options(node, plan))
    except (UnusableError, ParameterException, RuntimeError) as error:
        print(f"{name}: {error}", file=sys.stderr)
        return UNUSABLE
    try:
        return watch_until(stop, node, watch)
    finally:
        try_shutdown()


def parse_arguments(about: str) -> None:
    """Answer `--help`, and refuse what is neither that nor meant for ROS."""
    parser = argparse.ArgumentParser(
        description=about, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.parse_args(remove_ros_args(sys.argv)[1:])


def watch_until(stop: threading.Event, node: Node, watch: Watch) -> int:
    """Let messages come in until `stop` is set or `watch` has ended; the exit code."""
    executor = fastest_executor()
    executor.add_node(node)
    while not stop.is_set() and not watch.has_ended:
        executor.spin_once(timeout_sec=LONGEST_WAIT)
        watch.attend()
    if not watch.has_ended:
        take_what_came(executor, watch)
    return watch.end()


def fastest_executor() -> Executor:
    """The events executor where rclpy has it: it needs half the time for a message."""
    try:
        from rclpy.experimental import EventsExecutor
    except ImportError:
        return SingleThreadedExecutor()
    return EventsExecutor()


def take_what_came(executor: Executor, watch: Watch) -> None:
    """Let those messages in that had arrived when the signal came."""
    deadline = time.monotonic() + 1.0
    idle = 0
    while idle < 10 and time.monotonic() < deadline:
        before = watch.messages
        executor.spin_once(timeout_sec=0.0)
        idle = idle + 1 if watch.messages == before else 0
