/** The list of keys. */

import type { JSX } from "preact";
import { useEffect, useRef } from "preact/hooks";
import { KEYS, keysOn, setKeys } from "../keys";
import { helpOpen } from "../state";

const NAMES: Readonly<Record<string, string>> = { ArrowDown: "↓", ArrowUp: "↑", ArrowLeft: "←", ArrowRight: "→", Escape: "Esc" };

export function Help(): JSX.Element {
  const dialog = useRef<HTMLDialogElement>(null);
  useEffect(() => {
    if (helpOpen.value) dialog.current?.showModal();
    else dialog.current?.close();
  }, [helpOpen.value]);
  return (
    <dialog ref={dialog} aria-labelledby="help" onClose={() => (helpOpen.value = false)}>
      <h2 id="help">Keys</h2>
      <div class="keys">
        {[...new Set(KEYS.map((one) => one.group))].map((group) => (
          <section key={group} aria-label={group}>
            <h3>{group}</h3>
            <dl>
              {KEYS.filter((one) => one.group === group).map((one) => (
                <div key={one.says}><dt>{one.keys.map((key) => <kbd key={key}>{NAMES[key] ?? key.toUpperCase()}</kbd>)}</dt><dd>{one.says}</dd></div>
              ))}
            </dl>
          </section>
        ))}
      </div>
      <p>On the surface arrows turn the view; on the timeline they step frames. Drag turns, right drag or shift drag shifts, the wheel zooms.</p>
      <p><label class="check"><input type="checkbox" checked={keysOn.value} onChange={(event) => setKeys(event.currentTarget.checked)} /> single keys act</label></p>
      <button type="button" onClick={() => (helpOpen.value = false)}>Close</button>
    </dialog>
  );
}
