import { expect, test } from "vitest";
import cases from "../../tests/data/review_cases.json";
import { fold, lastStanding, readRecords, type ReviewRecord, type Target } from "../src/model/review";

interface Case {
  readonly name: string;
  readonly defects: readonly Target[];
  readonly records: readonly ReviewRecord[];
  readonly expected: Readonly<Record<string, Record<string, unknown>>>;
  readonly unattached: readonly string[];
}
const CASES = cases as unknown as Case[];

test.each(CASES.map((one) => [one.name, one] as const))("after all records: %s", (_, one) => {
  const folded = fold(one.records, one.defects);
  expect(folded.unattached.map((lost) => lost.name)).toEqual(one.unattached);
  expect(new Set(folded.findings.keys())).toEqual(new Set([...Object.keys(one.expected), ...one.defects.map((defect) => `D${defect.id}`)]));
  for (const [name, expected] of Object.entries(one.expected)) expect(folded.findings.get(name)?.review).toMatchObject(expected);
});

test("records from before they had ids are read, and an undo still means its record", () => {
  const target: Target = { kind: "defect", id: 1, label: "dent", model: 0, centroid: [0, 0, 1] };
  const old = [
    { revision: 1, target, action: "accept", value: null, reason: null, time: "t1" },
    { revision: 2, target, action: "note", value: "1", reason: null, time: "t2" },
    { revision: 3, target, action: "undo", value: 1, reason: null, time: "t3" },
  ];
  const read = readRecords(JSON.stringify(old)) ?? [];
  expect(read.map((one) => one.id)).toEqual(["v1-1-t1", "v1-2-t2", "v1-3-t3"]);
  expect(fold(read, [target]).findings.get("D1")?.review).toMatchObject({ state: "open", notes: [{ text: "1" }] });
  expect(readRecords("[1]")).toBeNull();
});

test("an undo takes back the last word of the same author", () => {
  const target: Target = { kind: "defect", id: 1, label: "dent", model: 0, centroid: [0, 0, 1] };
  const say = (revision: number, by: string): ReviewRecord => ({ id: `r${revision}`, revision, target, action: "accept", value: null, reason: null, time: "t", by });
  expect(lastStanding([say(1, "a"), say(2, "b")], "a")?.id).toBe("r1");
  expect(lastStanding([say(1, "a"), say(2, "b")])?.id).toBe("r2");
  expect(lastStanding([], "a")).toBeNull();
});
