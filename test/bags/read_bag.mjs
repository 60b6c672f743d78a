// Prints the messages of an MCAP file as JSON lines: topic, type, log time, value; by the readers of Foxglove.
import { createRequire } from 'node:module';
import { open } from 'node:fs/promises';

const require = createRequire(process.argv[2]);
const { McapIndexedReader } = require('@mcap/core');
const { parse } = require('@foxglove/rosmsg');
const { MessageReader } = require('@foxglove/rosmsg2-serialization');
const { decompress } = require('fzstd');

const file = await open(process.argv[3]);
const readable = {
  size: async () => BigInt((await file.stat()).size),
  read: async (offset, size) => {
    const buffer = new Uint8Array(Number(size));
    await file.read(buffer, 0, Number(size), Number(offset));
    return buffer;
  },
};
const plain = (key, value) => {
  if (typeof value === 'bigint') return value.toString();
  if (ArrayBuffer.isView(value)) return Array.from(value);
  return typeof value === 'number' && !Number.isFinite(value) ? String(value) : value;
};
const decompressHandlers = { zstd: (data, size) => decompress(data, new Uint8Array(Number(size))) };
const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
const readers = new Map();
for await (const message of reader.readMessages()) {
  const channel = reader.channelsById.get(message.channelId);
  const schema = reader.schemasById.get(channel.schemaId);
  if (!readers.has(schema.id)) {
    const definition = parse(new TextDecoder().decode(schema.data), { ros2: true });
    readers.set(schema.id, new MessageReader(definition));
  }
  const value = readers.get(schema.id).readMessage(message.data);
  console.log(JSON.stringify([channel.topic, schema.name, message.logTime, value], plain));
}
