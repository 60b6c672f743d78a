"""Makes a bag of any size for a test, and analyses one in a process of its own: `python large_bag.py MEGABYTES DIR`."""

import math
import struct
import subprocess
import sys
from pathlib import Path

from omni_vehicle_ros import messages
from omni_vehicle_ros.bags import BagWriter
from omni_vehicle_ros.interface import topic
from omni_vehicle_ros.wheels import WHEELS, drive_joint, steer_joint

PERIOD = 5_000_000
TURN = 2000
JOINTS = (*map(steer_joint, WHEELS), *map(drive_joint, WHEELS))
MEASURE = """
import resource, sys
from pathlib import Path
from omni_vehicle_ros.analysis.bags.analysis import analyse, read_subjects
from omni_vehicle_ros.analysis.bags.report import write_analysis
found = analyse(read_subjects([Path(sys.argv[1])]))
directory = Path(sys.argv[2])
directory.mkdir()
write_analysis(found, directory)
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024)
"""


def cycle(k: int) -> list[tuple[str, bytes]]:
    """Return what a vehicle on a circle says in one of the cycles of a lap."""
    angle = 2.0 * math.pi * k / TURN
    steer, wave = 0.1 + 0.05 * math.sin(3.0 * angle), math.sin(5.0 * angle)
    position, speeds = (steer, steer, -steer, -steer, 0.0, 0.0, 0.0, 0.0), (0.0,) * 4 + (10.0 + wave,) * 4
    forces = tuple((100.0 * wave, 900.0, 3000.0 + 500.0 * wave) for _ in WHEELS)
    values = {
        'joint_states': messages.Joints(0, JOINTS, position, speeds, (0.0,) * 8),
        'odom': messages.Odometry(0, 10.0 * math.sin(angle), 10.0 - 10.0 * math.cos(angle), angle, 5.0, wave, 0.5),
        'imu': messages.Imu(0, 0.01 * wave, angle, 0.5, wave, 2.5, 9.81),
        'tyres/side_slip': messages.Joints(0, WHEELS, (0.01 * wave,) * 4, (5.0,) * 4, (0.3 + 0.1 * wave,) * 4),
        'tyres/force': messages.Forces(0, WHEELS, forces),
        'commanded_twist': messages.Twist(0, 5.0, 0.0, 0.5),
        'front_left/command': messages.Joints(0, JOINTS[::4], (steer, 0.0), (0.0, 10.0), (0.0, 1.0)),
    }
    return [(name, messages.encode(topic(name).type, value)) for name, value in values.items()]


def write_large_bag(directory: Path, size: int) -> int:
    """Write laps until the bag has a size [byte]; return the number of cycles."""
    lap = [[(f'/{name}', bytearray(data)) for name, data in cycle(k)] for k in range(TURN)]
    k = 0
    with BagWriter(directory, compression='none') as writer:
        for name, _ in cycle(0):
            writer.add_topic(f'/{name}', topic(name).type, topic(name).qos)
        while k % TURN or writer.path.stat().st_size < size:
            stamp = k * PERIOD
            header = struct.pack('<iI', *divmod(stamp, 1_000_000_000))
            for name, data in lap[k % TURN]:
                data[4:12] = header
                writer.write(name, bytes(data), stamp)
            k += 1
    return k


def analysed(bag: Path, out: Path) -> int:
    """Analyse a bag in a process of its own; return the most memory that it took [MiB]."""
    command = [sys.executable, '-c', MEASURE, str(bag), str(out)]
    return int(subprocess.run(command, capture_output=True, text=True, check=True).stdout)


if __name__ == '__main__':
    target = Path(sys.argv[2])
    cycles = write_large_bag(target / 'bag', round(float(sys.argv[1]) * 1e6))
    print(f'{cycles} cycles, {analysed(target / "bag", target / "out")} MiB')
