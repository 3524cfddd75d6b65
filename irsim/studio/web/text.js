// The editor of the text: CodeMirror with the findings of the server; its history holds edits by mouse, too.

import {
  autocompletion, bracketMatching, closeBrackets, closeBracketsKeymap, completionKeymap, defaultKeymap, drawSelection,
  EditorSelection, EditorState, EditorView, foldGutter, foldKeymap, highlightActiveLine, highlightActiveLineGutter,
  highlightSelectionMatches, HighlightStyle, history, historyKeymap, indentOnInput, indentUnit, isolateHistory, keymap,
  lineNumbers, lintGutter, lintKeymap, searchKeymap, setDiagnostics, syntaxHighlighting, tags, yaml,
} from "./vendor/codemirror.js";

const LOOK = EditorView.theme({
  "&": { backgroundColor: "var(--card)", color: "var(--ink)", fontSize: "13px" },
  ".cm-scroller": { fontFamily: "ui-monospace, 'DejaVu Sans Mono', monospace", lineHeight: "1.5" },
  ".cm-gutters": { backgroundColor: "var(--page)", color: "var(--muted)", borderRight: "1px solid var(--line)" },
  ".cm-activeLine, .cm-activeLineGutter": { backgroundColor: "color-mix(in srgb, var(--accent) 8%, transparent)" },
  "&.cm-focused .cm-cursor": { borderLeftColor: "var(--ink)" },
  ".cm-tooltip": { backgroundColor: "var(--card)", color: "var(--ink)", border: "1px solid var(--line)" },
  ".cm-tooltip-autocomplete ul li[aria-selected]": { backgroundColor: "var(--accent)", color: "var(--on-accent)" },
  ".cm-panels, .cm-panels input, .cm-panels button": { backgroundColor: "var(--card)", color: "var(--ink)", backgroundImage: "none" },
});
const COLORS = HighlightStyle.define([
  { tag: tags.comment, color: "var(--muted)" },
  { tag: [tags.propertyName, tags.definition(tags.propertyName)], color: "var(--accent)" },
  { tag: [tags.number, tags.bool, tags.null, tags.string, tags.content], color: "var(--ink)" },
  { tag: [tags.labelName, tags.meta], color: "var(--warn)" },
]);

/**
 * An editor in an element. `changed(byUser)` is called after each change of the text, `moved(line)` when the cursor is
 * on another line, `complete(context)` when something may be completed.
 */
export function makeText(parent, { changed, moved, complete, keys }) {
  let line = 0;
  const watch = EditorView.updateListener.of((update) => {
    if (update.docChanged) changed();
    const now = update.state.doc.lineAt(update.state.selection.main.head).number;
    if (update.selectionSet && !update.docChanged && now !== line) moved(now);
    line = now;
  });
  const extensions = [
    lineNumbers(), foldGutter(), lintGutter(), history(), drawSelection(), indentOnInput(), bracketMatching(), closeBrackets(),
    autocompletion({ override: [complete], icons: false }), highlightActiveLine(), highlightActiveLineGutter(), highlightSelectionMatches(),
    indentUnit.of("  "), EditorState.tabSize.of(2), yaml(), syntaxHighlighting(COLORS), LOOK, watch,
    EditorView.contentAttributes.of({ "aria-label": "YAML of the scenario" }),
    keymap.of([...keys, ...closeBracketsKeymap, ...defaultKeymap, ...searchKeymap, ...historyKeymap, ...foldKeymap, ...completionKeymap, ...lintKeymap]),
  ];
  const view = new EditorView({ parent, state: EditorState.create({ extensions }) });
  return {
    view,
    get: () => view.state.doc.toString(),
    /** Another document, with a history of its own. */
    open(text) {
      view.setState(EditorState.create({ doc: text, extensions }));
    },
    /** Replace the part of the text that differs, as one step of the history. */
    put(text) {
      const before = view.state.doc.toString();
      const { from, to, insert } = difference(before, text);
      if (from === to && !insert) return;
      view.dispatch({ changes: { from, to, insert }, annotations: isolateHistory.of("full"), userEvent: "input.scene" });
    },
    goTo(number, focus = true) {
      const { from } = view.state.doc.line(Math.min(Math.max(1, number), view.state.doc.lines));
      view.dispatch({ selection: EditorSelection.cursor(from), effects: EditorView.scrollIntoView(from, { y: "center" }) });
      if (focus) view.focus();
    },
    /** Underline findings; each may have a function that mends it. */
    mark(findings) {
      const { doc } = view.state;
      const marks = findings.map(({ severity, message, fix, line: at, column, length, mend, code }) => {
        const row = doc.line(Math.min(Math.max(1, at ?? 1), doc.lines)), from = Math.min(row.to, row.from + Math.max(0, (column ?? 1) - 1));
        return {
          from, to: Math.min(row.to, from + Math.max(1, length ?? 1)), severity: severity === "hint" ? "info" : severity, source: code,
          message: fix ? `${message}\nfix: ${fix}` : message, actions: mend ? [{ name: "Fix", apply: mend }] : [],
        };
      });
      view.dispatch(setDiagnostics(view.state, marks.sort((a, b) => a.from - b.from)));
    },
  };
}

/** The smallest part in which two texts differ. */
export function difference(before, after) {
  const most = Math.min(before.length, after.length);
  let from = 0, end = 0;
  while (from < most && before[from] === after[from]) from++;
  while (end < most - from && before[before.length - 1 - end] === after[after.length - 1 - end]) end++;
  return { from, to: before.length - end, insert: after.slice(from, after.length - end) };
}
