// A worker that holds bmod. It first gets the compiled module, then one request after the other.

import { start, type Call } from './bmod';

export type FromWorker =
  | { kind: 'answer'; answer: unknown }
  | { kind: 'failed'; why: string }
  | { kind: 'print' | 'progress'; text: string };

const say = (message: FromWorker) => postMessage(message);
let complaint = '';
let call: Promise<Call> | undefined;

addEventListener('message', async ({ data }: MessageEvent) => {
  if (data instanceof WebAssembly.Module) {
    call = start(data, {
      print: (text) => say({ kind: 'print', text }),
      progress: (text) => say({ kind: 'progress', text }),
      complain: (text) => (complaint += text),
    });
    return;
  }
  complaint = '';
  try {
    say({ kind: 'answer', answer: (await call!)(data) });
  } catch (error) {
    say({ kind: 'failed', why: complaint || String(error) });
  }
});
