/** What Python gives to the scripts, and what they give each other. */

/** A cell, as its column and row. */
type Cell = [number, number];
type Side = "N" | "E" | "S" | "W";

// -- pages: `render/page.py` and `render/page_things.py` -------------------------------------

/** A shape is its kind and colour, and what its painter takes; see `paint.js`. */
type Shape = [number, number, ...(number | string)[]];
/** Shapes around a point. */
type Group = [number, number, Shape[]];

/** What is the same for all levels. */
interface Common {
  cell: number;
  events: string[];
  cheer: number;
  phases: number;
  max_cells: number;
  max_states: number;
  steps: number;
  bar: number;
  headings: number[][];
  /** The kinds that doors and exits can need, and what they are then: held, or on. */
  needed: Record<string, string>;
  spots: number[][];
  robot: string[];
  palette: string[];
  shapes: Shape[];
  sprites: number[][][];
  /** Of pages, and of galleries. */
  made_by: string;
  /** Of pages that open links. */
  code_versions: number[];
  play_versions: number[];
  max_unpacked: number;
  dictionary: string;
  /** Of the editor: the kinds, what lies on top first, and those at sides. */
  on_top: string[];
  at_sides: string[];
  none_needed: string;
  tools: Omit<Tool, "gesture">[];
  modifiers: Omit<Tool, "gesture">[];
  /** What steps are called that are undone. */
  steps_undone: Record<string, string>;
  /** What is said of keys, in groups: the keys as they are shown, and what they do. */
  keys: { title: string; keys: [string, string][] }[];
  answers: string;
  example: string;
  frame: string;
  learn: string;
  text: string;
  themes: Record<string, Theme>;
}

interface Theme {
  colors: Record<string, string>;
}

/** Links that were made by earlier versions lack what is optional here. */
interface LevelData {
  title: string;
  description: string;
  facts: [string, string][];
  width: number;
  height: number;
  margin: number;
  speed: number;
  starts: number[];
  exits: number[];
  max_steps: number | null;
  discount?: number;
  good_ends?: number[];
  /** Without NumPy there are no tables, and nothing is played. */
  rows?: number[][];
  table?: number[];
  possible: number[];
  robot: string[];
  picture: PictureData;
  things?: Thing[];
  /** Of levels with several: in each configuration, whether one has arrived. */
  robots?: { name: string; color: string; arrived: number[] }[];
  /** Whether the episode ends when the first robot has arrived. */
  ends_first?: boolean;
  marks?: Marks;
  turns?: Answers & { on: boolean; heading: number };
  rules?: [Group[], string, number[]][];
  goal?: string;
  alt?: string;
  seed: string;
  walker: "best" | "random" | "agent" | "sight" | null;
  /** Of pages, not of links. */
  agent?: AgentData;
  sight?: SightData;
  shown: string[];
  policy: number[] | null;
  best: string;
  returns?: Returns;
  code?: string;
  /** Whether the page learns the level; by default, where it knows the optimum. */
  learn?: boolean;
}

/** An agent: the number of its choice in each state, and what is shown; see `agent_data`. */
interface AgentData {
  choices: number[][];
  policy: number[];
  marks: Marks;
  legend?: Group[];
  costs?: { marks: Marks; legend: Group[] };
}

/** A sight, and its best agent; see `extensions/sight/page.py`. */
interface SightData {
  shown: number[];
  field?: number[];
  fields?: number[][];
  roots?: number[];
  nodes?: [number, ...number[][]][];
  agents?: number[][][];
}

/** The number of the mark of each state. */
interface Marks {
  values?: number[];
  policy?: number[];
}

/** What is known about the robot as it moves. */
interface Answers {
  marks?: Marks;
  policy: number[] | null;
  best: string;
  returns?: Returns;
}

interface Returns {
  best: number;
  random: number | null;
  /** Of levels without a time limit; null where no return is finite. */
  values?: (number | null)[];
}

interface PictureData {
  width: number;
  height: number;
  legend?: number;
  layers: Record<string, Group[]>;
  palette: string[];
  scale?: string[];
  looks?: Group[][];
  marks?: Group[][];
  never?: number;
  tiles?: number[];
  never?: number;
}

/** An item, a door, a switch, a mover or the exit; see `things_data`. */
interface Thing {
  kind: string;
  name: string;
  values: number[];
  looks: number[][];
  cells?: number[][];
  icon?: number[];
  sides?: number[];
  exits?: number[][];
  needs?: string[];
  label?: number;
}

// -- the editor: `editor/state.py` and `editor/protocol.py` ---------------------------------------

interface EditorState {
  number: number;
  revision: number;
  text: string;
  name: string | null;
  path: string | null;
  is_made: boolean;
  is_valid: boolean;
  is_saved: boolean;
  can_undo: boolean;
  can_redo: boolean;
  lacks: string;
  maze_regrown: boolean;
  lost: string;
  left: string;
  findings: Finding[];
  findings_pending: boolean;
  unreachable: Cell[];
  answers: any;
  level: LevelData | null;
  places: Place[];
  fields: Record<string, any>;
  too_large: string | null;
  theme?: Theme;
  contrast?: any[];
  /** In the first state alone. */
  forms?: Record<string, Field[]>;
  themes?: Record<string, Theme>;
}

/** What is wrong with the level, or could be better; see `findings_of`. */
interface Finding {
  code: string;
  severity: "error" | "warning" | "info";
  title: string;
  message: string;
  help: string | null;
  line: number;
  column: number;
  end_line: number;
  end_column: number;
  cells: Cell[];
  sides: [number, number, Side][];
  fix: { message: string; safe: boolean } | null;
  is_outdated: boolean;
}

/** What stands in cells or at sides; see `places_of`. */
interface Place {
  kind: string;
  label: string;
  route: (string | number)[];
  cells: Cell[];
  sides: [number, number, Side][];
  lines: number[];
  columns?: number[];
  fields: Record<string, any>;
}

/** A field of the level or of an entry; see `editor/forms.py`. */
interface Field {
  name: string;
  route: (string | number)[];
  type: string;
  label?: string;
  [more: string]: any;
}

/** `do` is what is asked for; the rest depends on that. */
interface Message {
  do: string;
  [field: string]: any;
}

interface Reply {
  id?: string | number | null;
  error?: string;
  state?: EditorState;
  /** Or the number of a state, and what changed in it; see `editor/differences.py`. */
  from?: number;
  changes?: any;
  [more: string]: any;
}

interface Connection {
  /** Whether one can ask the other side to end. */
  ends: boolean;
  send(message: Message): Promise<Reply>;
}

/** Where a pointer or the cursor is: see `spots.js`. */
interface Spot {
  at: [number, number];
  cell: Cell | null;
  side: Side | null;
  rim: Side | null;
}

/** A straight run of sides, as the gesture `walls` has it. */
interface Run {
  at: Cell;
  side: Side;
  length?: number;
}

interface Tool {
  name: string;
  key: string;
  title: string;
  hint: string;
  icon: string;
  /** What it builds at sides. */
  builds?: "wall" | "glass" | "door";
  /** It paints one cell; with Shift, one more where `isMore`. */
  isSingle?: boolean;
  isMore?: boolean;
  isRectangle?: boolean;
  gesture(editor: Editor, tool: Tool, spots: Spot[], how: { rectangle?: boolean; fill?: boolean }): Message | null;
}

/** A place in a line of text, from a column to another. */
interface Mark {
  from: number;
  to: number;
  kind: string;
}

// -- what scripts give each other -----------------------------------------------------------------

type Game = import("../../babyrobot_levels/render/static/game.js").Game;
type Painter = import("../../babyrobot_levels/render/static/paint.js").Painter;
type View = import("../../babyrobot_levels/render/static/view.js").View;
type Editor = import("../../babyrobot_levels/extensions/editor/static/editor.js").Editor;
type Picture = import("../../babyrobot_levels/render/static/picture.js").Picture;
type Stage = import("../../babyrobot_levels/extensions/editor/static/stage.js").Stage;
type Overlay = import("../../babyrobot_levels/extensions/editor/static/overlay.js").Overlay;
type Pointer = import("../../babyrobot_levels/extensions/editor/static/pointer.js").Pointer;

/** How an episode ended. */
type End = "exit" | "good" | "hit" | "over" | "time";

/** A step of an episode, and its poses during and after it. */
interface Step {
  from: number;
  action: number;
  move: number;
  next: number;
  reward: number;
  event: string;
  hit: Thing | null;
  pose: number;
  after: number;
}

/** The commands of a path, with places in tenths of a pixel. */
type Outline = [string, number[]][];

// -- pages have elements of HTML, and their events come from elements -----------------------------

interface ParentNode {
  querySelectorAll(selectors: string): NodeListOf<HTMLElement>;
}

interface EventTarget {
  matches(selectors: string): boolean;
}
