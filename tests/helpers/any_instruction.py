"""Interrupt the loop over what threads do at every n-th instruction of Python: `python any_instruction.py N`."""

from __future__ import annotations

import os
import signal
import sys
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from types import FrameType
from typing import Any

from places import ROOT


def interrupted_at(instruction: int) -> str | None:
    """Run the loop, and send this process SIGINT at an instruction; return how it ended, None if it has none such."""
    from reference.system.workers import as_done

    threads, done = ThreadPoolExecutor(1), 0

    def trace(frame: FrameType, event: str, _: object) -> Any:
        nonlocal done
        frame.f_trace_opcodes = True
        done += event == "opcode"
        if event == "opcode" and done == instruction:
            signal.raise_signal(signal.SIGINT)
        return trace

    end = "no exception"
    sys.settrace(trace)
    try:
        for _ in as_done(lambda _: threads.submit(time.sleep, 0.003), range(3), 2):
            pass
    except BaseException as error:
        end = repr(error)
    finally:
        sys.settrace(None)
    threads.shutdown(wait=False, cancel_futures=True)
    for thread in threads._threads:
        thread.join(10)
        end += ", and a thread waits without end" * thread.is_alive()
    if signal.pthread_sigmask(signal.SIG_BLOCK, []) or signal.getsignal(signal.SIGINT) != signal.default_int_handler:
        end += ", and signals are still held back"
    return end if done >= instruction else None


if __name__ == "__main__":
    sys.path.insert(0, str(ROOT))
    signal.signal(signal.SIGINT, signal.default_int_handler)
    ends: Counter[str] = Counter()
    instruction = step = int(sys.argv[1])
    while (end := interrupted_at(instruction)) is not None:
        ends[end] += 1
        instruction += step
    print(ends.total(), dict(ends), flush=True)
    os._exit(0)  # threads that wait without end are not waited for
