"""The checksum of MCAP: CRC-32, by ISA-L where it is installed, which takes a twentieth of the time of zlib."""

try:
    from isal.isal_zlib import crc32
except ImportError:  # rosdep has no key for it, and it is not needed
    from zlib import crc32

__all__ = ['crc32']
