# SPDX-License-Identifier: MIT
"""The text that a terminal gets from a program."""
import os


def read_terminal(primary):
    """All of it, until the other end is closed; then this end is, too."""
    text = b""
    while True:
        try:
            piece = os.read(primary, 65536)
        except OSError:  # as Linux says that the other end is closed
            break
        if not piece:
            break
        text += piece
    os.close(primary)
    return text
