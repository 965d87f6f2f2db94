; Each token has one capture: editors disagree on which of two wins.

(comment) @comment
(doc) @comment.documentation
(string) @string
(code) @constant
[(integer) (number) (unit_power)] @number
(unit_symbol) @type.builtin
(face) @property
(row) @string.special
(scene_block (word) @attribute)

[
  "after" "aggregate" "allow" "and" "as" "assembly" "at" "by" "captured" "complete" "completion" "deny" "else" "expect"
  "faster" "for" "from" "if" "import" "in" "layer" "least" "let" "mean" "mirrored" "not" "on" "or" "pattern" "phase" "plate" "probability"
  "release" "retry" "scene" "seed" "shape" "than" "timeout" "to" "turned" "wait" "with" "within" "yields"
] @keyword

[(arrow) (times) "=" "==" "!=" "<" "<=" ">" ">=" "+" "-" "*" "/" "%" "^" ".."] @operator
["," "."] @punctuation.delimiter
["{" "}" "(" ")" "[" "]"] @punctuation.bracket

; Names.

(assembly name: (name) @type)
(assembly scene: (name) @type)
(aggregate name: (name) @type)
(aggregate scene: (name) @type)
(scene name: (name) @type)
(scene scene: (name) @type)
(shape name: (name) @type)
(yields shape: (name) @type)
(phase name: (place (name) @type))
(expect program: (name) @type)
(event phase: (place (name) @type))

(pattern name: (name) @function)
(instance pattern: (name) @function)
(call function: (name) @function)

(let name: (name) @variable)
(default name: (name) @variable)
(for counter: (name) @variable)
(parameter name: (name) @variable)
(argument parameter: (name) @variable)
(argument (place (name) @variable))
(expression (name) @variable)
(condition (name) @variable)
(chain (place (name) @variable))
(after (place (name) @variable))
(release (place (name) @variable))
(event !phase (place (name) @variable))
(seat (place (name) @variable))
(instance (place (name) @variable))
