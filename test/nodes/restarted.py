"""Drives in circles to the left, then, when told to with SIGUSR1, to the right, and sees whether wheels follow."""

import signal

import rclpy
from manager import Manager


def follow(manager: Manager, sign: float) -> bool:
    """Whether both front wheels point to one side.

    One second of four it asks for speed 0: a vehicle that has come to a controlled stop, without its module or on a
    machine that is too slow, goes on after that.
    """
    manager.go(0.0 if manager.joints.header.stamp.sec % 4 == 3 else 2.0)
    return manager.steers(0, sign) and manager.steers(1, sign)


def drive() -> None:
    """Print each turn that the front wheels follow."""
    told: list[int] = []
    signal.signal(signal.SIGUSR1, lambda number, frame: told.append(number))
    manager = Manager()
    manager.turn(8.0)
    manager.until(lambda: follow(manager, 1.0), 'a turn to the left')
    print('left', flush=True)
    manager.until(lambda: bool(told), 'the signal')
    manager.turn(-8.0)
    manager.until(lambda: follow(manager, -1.0), 'a turn to the right')
    print('right', flush=True)
    manager.node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    drive()
