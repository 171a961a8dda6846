// The style sheet of the editor.

/** Python puts the text here where there is no server to ask for it. */
export const STYLE = "";
