import { expect, it } from "vitest";
import { GROUPS, planOf } from "../src/study/plan";
import { csvOf, stepOf, susScore, tlxScore, type Block, type Run } from "../src/study/record";

const TASKS = ["a", "b", "c", "d", "e", "f", "g", "h"];

it("shows everybody both conditions on different scenes, every pairing first once in four", () => {
  const plans = Array.from({ length: GROUPS }, (_, k) => planOf("s", k + 1, ["A", "B"], TASKS));
  expect(new Set(plans.map(([first]) => `${first!.condition} ${first!.scene}`)).size).toBe(4);
  for (const [first, second] of plans) {
    expect(first!.condition).not.toBe(second!.condition);
    expect(first!.scene).not.toBe(second!.scene);
    expect([...first!.order].sort()).toEqual(TASKS);
  }
});

it("draws an order for each person and part, the same again for the same", () => {
  const orders = Array.from({ length: 40 }, (_, k) => planOf("s", k + 1, ["A", "B"], TASKS)).flat().map((one) => one.order.join(""));
  expect(new Set(orders).size).toBeGreaterThan(75);
  const first = orders.map((order) => order[0]);
  for (const task of TASKS) expect(first.filter((one) => one === task).length).toBeGreaterThan(2);
  expect(planOf("s", 3, ["A", "B"], TASKS)).toEqual(planOf("s", 3, ["A", "B"], TASKS));
  expect(planOf("t", 3, ["A", "B"], TASKS)).not.toEqual(planOf("s", 3, ["A", "B"], TASKS));
});

it("scores the questionnaires as their authors do", () => {
  expect(susScore([5, 1, 5, 1, 5, 1, 5, 1, 5, 1])).toBe(100);
  expect(susScore([3, 3, 3, 3, 3, 3, 3, 3, 3, 3])).toBe(50);
  expect(susScore([1, 5, 1, 5, 1, 5, 1, 5, 1, 5])).toBe(0);
  expect(tlxScore({ mental: 100, physical: 0, temporal: 50, performance: 50, effort: 100, frustration: 0 })).toBe(50);
});

const answered = { task: "a", answer: "=1", seconds: 1.23456, confidence: 7, hidden_s: 0, reopened: 0 };
const block: Block = { condition: "page", scene: "A", order: ["a"], answers: [answered], sus: [3, 3, 3, 3, 3, 3, 3, 3, 3, 3], tlx: { mental: 25 } };
const RUN: Run = {
  schema_version: 1, study: "s", participant: 2, group: 1, consented: "", ended: "", window: [1, 1], background: { colour: "yes" },
  blocks: [block], preference: {},
};

it("writes one row for each task, and nothing that a spreadsheet would run", () => {
  const [head, row, end] = csvOf(RUN).split("\r\n");
  expect(head!.split(",").length).toBe(row!.split(",").length);
  expect(row).toBe("s,2,1,1,page,A,1,a,'=1,1.235,7,0.000,0,50,25.00");
  expect(end).toBe("");
  expect(csvOf({ ...RUN, blocks: [{ ...block, answers: [{ ...answered, answer: null }] }] })).toContain(",a,,1.235,");
});

it("goes on where a person stopped", () => {
  const at = (part: Partial<Block>, read: number[] = [], run: Partial<Run> = {}) => stepOf({ ...RUN, ended: null, ...run, blocks: [{ ...block, ...part }] }, new Set(read));
  expect(stepOf(null, new Set()).what).toBe("consent");
  expect(at({}, [], { background: {} }).what).toBe("background");
  expect(at({ answers: [] }).what).toBe("introduction");
  expect(at({ answers: [] }, [0])).toEqual({ what: "task", block: 0, position: 0 });
  expect(at({ order: ["a", "b"] })).toEqual({ what: "task", block: 0, position: 1 });
  expect(at({ sus: [] }).what).toBe("sus");
  expect(at({ tlx: {} }).what).toBe("tlx");
  expect(at({}).what).toBe("preference");
  expect(at({}, [], { ended: "now" }).what).toBe("end");
});
