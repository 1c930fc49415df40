// The blocks that src/io/page/page.cpp puts into the page: base64 of zlib's deflate.

export type Blocks = Readonly<Record<string, string>>;

export async function inflate(base64: string): Promise<Uint8Array<ArrayBuffer>> {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = text.charCodeAt(i);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Undoes the shuffle (all lowest bytes first) and the zigzag (the sign is the lowest bit). */
export function toIntegers(bytes: Uint8Array): Int32Array<ArrayBuffer> {
  const n = bytes.length / 4;
  const values = new Int32Array(n);
  for (let i = 0; i < n; ++i) {
    const zigzag = bytes[i] | (bytes[n + i] << 8) | (bytes[2 * n + i] << 16) | (bytes[3 * n + i] << 24);
    values[i] = (zigzag >>> 1) ^ -(zigzag & 1);
  }
  return values;
}

export async function readText(blocks: Blocks, name: string): Promise<string> {
  return new TextDecoder().decode(await inflate(blocks[name]));
}

/** All blocks of these names as arrays of whole numbers. */
export async function readIntegers<Name extends string>(
    blocks: Blocks, names: readonly Name[]): Promise<Record<Name, Int32Array<ArrayBuffer>>> {
  const arrays = await Promise.all(names.map(async (name) => toIntegers(await inflate(blocks[name]))));
  return Object.fromEntries(names.map((name, i) => [name, arrays[i]])) as
      Record<Name, Int32Array<ArrayBuffer>>;
}

/** In place: every value plus all before it. */
export function addUp<T extends Int32Array>(values: T): T {
  for (let i = 1; i < values.length; ++i) values[i] += values[i - 1];
  return values;
}
