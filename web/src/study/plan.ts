/** Who gets what in which order: counterbalanced by the number of the person, tasks in an order drawn for it. */

export const CONDITIONS = ["gallery", "page"] as const;
export type Condition = (typeof CONDITIONS)[number];

export interface PlannedBlock {
  readonly condition: Condition;
  readonly scene: string;
  readonly order: readonly string[];
}

export const GROUPS = 4;

/** Every four persons in a row see both conditions and both scenes first, in every pairing. */
export const groupOf = (participant: number): number => (participant - 1) % GROUPS;

/** Two blocks: one condition on one scene, then the other on the other. */
export function planOf(study: string, participant: number, scenes: readonly string[], tasks: readonly string[]): PlannedBlock[] {
  const group = groupOf(participant);
  return [0, 1].map((block) => ({
    condition: CONDITIONS[(group + block) % 2] as Condition,
    scene: scenes[((group >> 1) + block) % 2] as string,
    order: shuffled(tasks, drawn(`${study} ${participant} ${block}`)),
  }));
}

/** Fisher and Yates's shuffle. */
function shuffled(tasks: readonly string[], next: () => number): string[] {
  const order = [...tasks];
  for (let last = order.length - 1; last > 0; last--) {
    const other = Math.floor(next() * (last + 1));
    [order[last], order[other]] = [order[other] as string, order[last] as string];
  }
  return order;
}

/** Numbers in [0, 1) that follow from a text: FNV-1a of the text begins a xorshift of 32 bits (Marsaglia 2003). */
function drawn(text: string): () => number {
  let state = 0x811c9dc5;
  for (let k = 0; k < text.length; k++) state = Math.imul(state ^ text.charCodeAt(k), 0x01000193);
  state = state || 1;
  const next = (): number => {
    state ^= state << 13;
    state ^= state >>> 17;
    state ^= state << 5;
    return (state >>> 0) / 2 ** 32;
  };
  for (let k = 0; k < 8; k++) next(); // texts that differ in their last character differ little at first
  return next;
}
