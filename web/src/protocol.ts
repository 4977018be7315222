// What goes to bmod and comes back: the shapes of web/wasm/src/lib.rs and of the JSON report (docs/json.md).

import type { Question } from './service';

export type Project = { file: string; files: Record<string, string> };

export type Settings = {
  time_limit?: number;
  max_memory?: number;
  explain?: boolean;
  options?: [string, string][];
  scalars?: [string, number][];
  defines?: [string, string][];
};

export type Request =
  | ({ do: 'run' } & Project & Settings)
  | ({ do: 'view'; view: string } & Project & Settings)
  | { do: 'records'; name: string }
  | ({ do: 'edit'; file: string; main: string; open: Record<string, string>; close: string[] } & Question);

/** Lines and columns count from 1, columns in characters; the end is exclusive. */
export type Place = { file: string; line: number; column: number; end_line: number; end_column: number };

export type Diagnostic = Partial<Place> & {
  code: string;
  severity: 'error' | 'execution' | 'warning';
  message: string;
  label?: string;
  labels?: (Partial<Place> & { text: string })[];
  help?: string;
};

/** A number, or one of "+INF", "-INF", "EPS", "NA", "UNDF". */
export type Num = number | string;

export type Solve = {
  model: string;
  using: string;
  sense: string | null;
  solver: string;
  model_status: { code: number; name: string };
  solver_status: { code: number; name: string };
  objective: Num | null;
  rows: number;
  columns: number;
  nonzeros: number;
  iterations: number;
  seconds: { generate: number; solve: number; total: number };
  residual: { primal: Num | null; dual: Num | null; complementarity: Num | null; natural: Num | null };
  message?: string | null;
  why?: { text: string[] } | null;
};

export type Report = {
  bmod: string;
  status: 'ok' | 'compilation_error' | 'execution_error' | 'aborted' | 'interrupted';
  solves: Solve[];
  files: string[];
  diagnostics: Diagnostic[];
};

export type About = { name: string; kind: string; text: string; domain: string[]; records: number };
export type Table = { name: string; head: string[]; rows: Num[][] };

export type Answer = {
  report: Report;
  messages: string;
  printed: string;
  files: Record<string, string>;
  symbols: About[];
  claims: { what: string; holds: boolean }[];
  memory: number;
};
