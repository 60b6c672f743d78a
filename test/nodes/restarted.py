"""Drives in circles, left and right in turns; changes sides when told to, with SIGUSR1, and sees who follows."""

import signal

import rclpy
from manager import Manager


def drive() -> None:
    """Print each turn that the front wheels follow."""
    told: list[int] = []
    signal.signal(signal.SIGUSR1, lambda number, frame: told.append(number))
    manager = Manager()
    for turn, sign in enumerate((1.0, -1.0, 1.0)):
        manager.turn(8.0 * sign)
        manager.until(lambda sign=sign: manager.steers(0, sign) and manager.steers(1, sign), f'turn {turn}')
        if turn == 2:
            break
        print(f'turn {turn}', flush=True)
        manager.until(lambda turn=turn: len(told) > turn, 'the signal')
    print('done', flush=True)
    manager.node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    drive()
