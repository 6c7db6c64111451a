"""What libraries print is captured, by several threads too, and the descriptors come back."""

from __future__ import annotations

import os
import threading

from compare.methods.capture import captured


def test_what_is_written_is_captured_and_quoted_on_one_line(capfd):
    with captured(1, 2) as output:
        os.write(1, b"a step\n")
        os.write(2, b"failed\n")
    os.write(1, b"after\n")
    assert output.words() == "a step failed"
    assert capfd.readouterr().out == "after\n"


def test_threads_that_capture_at_once_give_the_descriptors_back(capfd):
    def capture():
        for _ in range(50):
            with captured(1) as output:
                os.write(1, b"quiet\n")
            assert output.data == b"quiet\n"

    threads = [threading.Thread(target=capture) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    os.write(1, b"after\n")
    assert capfd.readouterr().out == "after\n"
