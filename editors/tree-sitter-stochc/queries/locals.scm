[(program) (block)] @local.scope
(pattern) @local.scope
(for) @local.scope

(let name: (name) @local.definition)
(default name: (name) @local.definition)
(for counter: (name) @local.definition)
(parameter name: (name) @local.definition)

; A place names blocks: the first segment may be a parameter.
(seat . (place . (name) @local.definition))
(place . (name) @local.reference)
(expression (name) @local.reference)
