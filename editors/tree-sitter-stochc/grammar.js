// The grammar of assembly programs (`.sa`) for tree-sitter. It follows `grammar/src/sa.pest`; `editors/test/run` compares
// the two. Keywords are not names here, because the compiler rejects such names.

const FACES = ['up', 'down', 'north', 'south', 'east', 'west'];

/** One or more, separated by commas. */
const list = rule => seq(rule, repeat(seq(',', rule)));

module.exports = grammar({
  name: 'stochc',

  word: $ => $.name,

  extras: $ => [/[ \t\r\n]/, $.comment],

  // `src/scanner.c` reads units, which stand on the line of their number, and the `x` of `3 x3`.
  externals: $ => [$.unit_symbol, $.times, $._error_sentinel],

  rules: {
    program: $ => repeat($._element),

    _element: $ => choice(
      $.chain, $.seat, $.instance, $.release, $.yields, $.doc, $.wait, $.retry, $.expect, $.level,
      $.let, $.import, $.aggregate,
      $.phase, $.for, $.if, $.pattern, $.seed, $.assembly, $.scene, $.shape,
    ),

    block: $ => seq('{', repeat($._element), '}'),

    // Statements.

    chain: $ => seq($._first_place, repeat1(seq($.arrow, $.place)), optional($.after)),
    arrow: _ => choice('->', '->>'),
    after: $ => seq('after', choice(
      seq(list($._subject), optional(seq(',', $.time))),
      $.time,
    )),
    _subject: $ => seq(optional('release'), $.place),
    release: $ => seq('release', list($.place), optional($.after)),
    seat: $ => seq($._first_place, 'at', $.point),
    point: $ => seq('(', $.expression, ',', $.expression, ')'),
    instance: $ => seq(
      field('pattern', choice($.name, alias($._verdict, $.name))),
      '(', optional(list($.argument)), ')',
      optional('mirrored'),
      optional(seq('turned', $.expression)),
      optional(seq('at', $.point)),
      optional(seq('as', field('name', $.place))),
    ),
    argument: $ => seq(
      optional(seq(field('parameter', $.name), '=')),
      choice($.expression, $.place),
    ),
    yields: $ => seq('yields', optional(seq('at', 'least')), field('shape', $.name)),
    wait: $ => seq('wait', $.time),
    retry: $ => seq('retry', $.expression),
    expect: $ => seq('expect', choice(
      seq('mean', 'completion', $.relation, $.quantity),
      seq('faster', 'than', field('program', $.name), optional(seq('by', $.quantity))),
      seq($.event, optional(seq('within', $.quantity)), 'with', 'probability', $.relation, $.quantity),
    )),
    event: $ => choice(
      'complete', seq('phase', field('phase', $.place)), seq('captured', $.place, 'by', $.place),
    ),
    relation: _ => choice('>=', '<='),
    level: $ => seq($._verdict, $.code, optional($.string)),

    // Declarations.

    let: $ => seq('let', field('name', $.name), '=', $.expression),
    import: $ => seq('import', $.string),
    aggregate: $ => seq(
      'aggregate', field('name', $.name),
      optional(seq('in', field('scene', $.name))),
      'to', $.expression,
      optional(seq('timeout', $.quantity)),
    ),

    // Blocks.

    assembly: $ => seq(
      'assembly', field('name', $.name),
      optional($.defaults),
      optional(seq('in', field('scene', $.name))),
      $.block,
    ),
    defaults: $ => seq('(', optional(list($.default)), ')'),
    default: $ => seq(field('name', $.name), '=', $.expression),
    seed: $ => seq('seed', 'plate', $.expression, $.times, $.expression, $.block),
    phase: $ => seq(
      'phase', field('name', $.place), optional(seq('timeout', $.quantity)), $.block,
      optional($.handler),
    ),
    handler: $ => seq('on', 'timeout', $.block),
    for: $ => seq('for', field('counter', $.name), 'in', $.range, $.block),
    if: $ => prec.right(seq('if', $.condition, $.block, repeat($._else_if), optional($._else))),
    _else_if: $ => seq('else', 'if', $.condition, $.block),
    _else: $ => seq('else', $.block),
    pattern: $ => seq('pattern', field('name', $.name), $.parameters, $.block),
    parameters: $ => seq('(', optional(list($.parameter)), ')'),
    parameter: $ => seq(field('name', $.name), optional(seq('=', $.expression))),

    // Scenes and shapes.

    scene: $ => seq(
      'scene', field('name', $.name),
      optional(seq('from', field('scene', $.name))),
      $.scene_block,
    ),
    scene_block: $ => seq(
      '{',
      repeat(choice($.span_of_values, $.quantity, alias($.name, $.word), $.scene_block)),
      '}',
    ),
    span_of_values: $ => seq($.number, optional($.unit), '..', $.quantity),
    quantity: $ => seq($.number, optional($.unit)),
    time: $ => seq($.number, optional($._unit_factor)),
    unit: $ => seq($._unit_factor, repeat(seq(optional(choice('/', '*')), $._unit_factor))),
    _unit_factor: $ => seq($.unit_symbol, optional(seq(token.immediate('^'), $.unit_power))),
    unit_power: _ => token.immediate(/-?[0-9]{1,2}/),

    shape: $ => seq('shape', field('name', $.name), optional(seq('at', $.point)), $.shape_block),
    shape_block: $ => seq('{', repeat($.layer), '}'),
    layer: $ => seq('layer', choice($.range, $.expression), $.layer_block),
    layer_block: $ => seq('{', repeat($.row), '}'),
    row: _ => /[#.]([ \t]*[#.])*/,

    // Names and numbers.

    place: $ => prec(-1, seq($.name, optional($.index), repeat($._segment))),
    _segment: $ => seq('.', choice($.name, $.face), optional($.index)),
    face: _ => choice(...FACES),
    index: $ => seq('[', list(choice($.range, $.expression)), ']'),
    range: $ => seq($.expression, '..', $.expression),
    expression: $ => seq($._operand, repeat(seq(choice('+', '-', '*', '/', '%'), $._operand))),
    _operand: $ => seq(repeat('-'), choice($.integer, $.name, $.face, $.call, $.group)),
    group: $ => seq('(', $.expression, ')'),
    call: $ => seq(field('function', $.name), '(', list($.expression), ')'),
    condition: $ => seq($._condition_operand, repeat(seq($._condition_operator, $._condition_operand))),
    _condition_operator: _ => choice(
      '==', '!=', '<', '<=', '>', '>=', 'and', 'or', '+', '-', '*', '/', '%',
    ),
    _condition_operand: $ => choice(
      seq('not', $.condition_group),
      seq(repeat('-'), choice($.integer, $.name, $.face, $.call, $.condition_group)),
    ),
    condition_group: $ => seq('(', $.condition, ')'),

    // `allow` and `deny` are keywords at the start of a level only: blocks may have these names.
    _verdict: _ => choice('allow', 'deny'),
    _first_place: $ => choice($.place, alias($._verdict_place, $.place)),
    _verdict_place: $ => seq(alias($._verdict, $.name), optional($.index), repeat($._segment)),
    code: $ => choice($.name, token(/[A-Za-z_][A-Za-z0-9_]*(-[A-Za-z0-9_]+)+/)),

    integer: _ => /[0-9]+/,
    number: _ => /-?[0-9]+(\.[0-9]+)?([eE][+-]?[0-9]+)?/,
    name: _ => /[A-Za-z_][A-Za-z0-9_]*/,
    string: _ => /"[^"\n]*"/,
    // Three slashes document the next item. Four begin a comment again.
    doc: _ => /\/\/\/([^\/\n][^\n]*)?/,
    comment: _ => /\/\/([^\/\n][^\n]*)?|\/\/\/\/[^\n]*/,
  },
});
