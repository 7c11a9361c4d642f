/** What people read and mark: consent, questionnaires, and what each condition is. */

import type { Condition } from "./plan";

export const NAMES: Readonly<Record<Condition, string>> = { gallery: "gallery", page: "linked page" };

export const INTRODUCTIONS: Readonly<Record<Condition, string>> = {
  gallery: "The gallery shows two pictures of the surface, a table of the findings, and the frames of the video with their boxes. A click on a frame enlarges it; a click on a finding in the table shows its frames alone.",
  page: "The linked page shows a list of the findings, the surface, a frame of the video and a timeline. Whatever you choose in one of them is shown in the others. The button ? at the upper right lists the keys.",
};

export const CONSENT: readonly string[] = [
  "This study compares two ways to show the result of a borescope inspection. You answer eight questions with each and say what you think of it. It takes about 40 minutes.",
  "Recorded are your answers, how long each took and how sure you were, what you mark in the questionnaires, three answers about your experience, when you began and ended, whether the window was hidden, its size, and the number that you were given. No name, no voice and no picture of you is recorded.",
  "Everything stays in this browser until it is saved as two files at the end. Nothing is sent anywhere.",
  "You may stop at any moment and without a reason: the button at the upper right deletes what was recorded.",
  "What is tested are the two ways of showing, not you. Some questions may have no answer in what is shown; then “I cannot tell” is right.",
];

/** Brooke (1996), with “system” as there. */
export const SUS: readonly string[] = [
  "I think that I would like to use this system frequently.",
  "I found the system unnecessarily complex.",
  "I thought the system was easy to use.",
  "I think that I would need the support of a technical person to be able to use this system.",
  "I found the various functions in this system were well integrated.",
  "I thought there was too much inconsistency in this system.",
  "I would imagine that most people would learn to use this system very quickly.",
  "I found the system very cumbersome to use.",
  "I felt very confident using the system.",
  "I needed to learn a lot of things before I could get going with this system.",
];

export interface Scale {
  readonly name: string;
  readonly title: string;
  readonly question: string;
  readonly ends: readonly [string, string];
}

const LOW_TO_HIGH = ["very low", "very high"] as const;
/** NASA TLX (Hart and Staveland 1988). */
export const TLX: readonly Scale[] = [
  { name: "mental", title: "Mental demand", question: "How mentally demanding was the task?", ends: LOW_TO_HIGH },
  { name: "physical", title: "Physical demand", question: "How physically demanding was the task?", ends: LOW_TO_HIGH },
  { name: "temporal", title: "Temporal demand", question: "How hurried or rushed was the pace of the task?", ends: LOW_TO_HIGH },
  { name: "performance", title: "Performance", question: "How successful were you in accomplishing what you were asked to do?", ends: ["perfect", "failure"] },
  { name: "effort", title: "Effort", question: "How hard did you have to work to accomplish your level of performance?", ends: LOW_TO_HIGH },
  { name: "frustration", title: "Frustration", question: "How insecure, discouraged, irritated, stressed and annoyed were you?", ends: LOW_TO_HIGH },
];

export interface Choice {
  readonly name: string;
  readonly question: string;
  readonly options: readonly string[];
}

export const BACKGROUND: readonly Choice[] = [
  { name: "borescope", question: "How long have you worked with borescope inspections?", options: ["never", "less than 1 year", "1 to 5 years", "more than 5 years"] },
  { name: "models_3d", question: "How often do you use programs that show 3D models?", options: ["never", "sometimes", "every week"] },
  { name: "colour", question: "Do you see colours as most people do?", options: ["yes", "no", "I do not know"] },
];

const EITHER = ["gallery", "linked page", "no preference"];
export const PREFERENCE: readonly Choice[] = [
  { name: "counting", question: "Which would you take to count findings?", options: EITHER },
  { name: "ranking", question: "Which would you take to say which finding matters most?", options: EITHER },
  { name: "understanding", question: "Which would you take to understand where a finding lies?", options: EITHER },
  { name: "work", question: "Which would you take for your work?", options: EITHER },
];
