<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE TS>
<TS version="2.1" language="es" sourcelanguage="en">
<context>
    <name>TerrAInav</name>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>Area from a file</source>
        <translation>Área de un archivo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>Area from polygons of a layer</source>
        <translation>Área de polígonos de una capa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>Click one polygon of “{layer}” on the map.</source>
        <translation>Haga clic en un polígono de «{layer}» en el mapa.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>Click the first corner</source>
        <translation>Haga clic en el primer vértice</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>Click the first corner of one more polygon</source>
        <translation>Haga clic en el primer vértice de otro polígono</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>Click the first corner of the hole</source>
        <translation>Haga clic en el primer vértice del hueco</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>Click the first corner of the no-fly area</source>
        <translation>Haga clic en el primer vértice de la zona de exclusión</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>Extent of a layer</source>
        <translation>Extensión de una capa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>Go on drawing; Backspace removes the last corner.</source>
        <translation>Siga dibujando; Retroceso quita el último vértice.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>No area was taken.</source>
        <translation>No se ha tomado ningún área.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>No area: {reason}</source>
        <translation>Sin área: {reason}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>No-fly areas from a file</source>
        <translation>Zonas de exclusión de un archivo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>No-fly areas from a layer</source>
        <translation>Zonas de exclusión de una capa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>Polygons (*.kml *.kmz *.geojson *.json);;All files (*)</source>
        <translation>Polígonos (*.kml *.kmz *.geojson *.json);;Todos los archivos (*)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>Text file of points: lat lon agl [yaw], or a table with a header</source>
        <translation>Archivo de texto con puntos: lat lon agl [guiñada], o una tabla con encabezado</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>Text files (*.txt *.csv *.dat);;All files (*)</source>
        <translation>Archivos de texto (*.txt *.csv *.dat);;Todos los archivos (*)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>The area is unchanged.</source>
        <translation>El área no ha cambiado.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>Trajectories and flight logs (*.gpx *.ulg *.bin *.log *.txt *.csv);;All files (*)</source>
        <translation>Trayectorias y registros de vuelo (*.gpx *.ulg *.bin *.log *.txt *.csv);;Todos los archivos (*)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>Trajectory or flight log</source>
        <translation>Trayectoria o registro de vuelo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>add a polygon</source>
        <translation>añadir un polígono</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>area file</source>
        <translation>archivo del área</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>cut a hole</source>
        <translation>recortar un hueco</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>draw a no-fly area</source>
        <translation>dibujar una zona de exclusión</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>draw box</source>
        <translation>dibujar recuadro</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>draw polygon</source>
        <translation>dibujar polígono</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>extent of {layer}</source>
        <translation>extensión de {layer}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>line of {layer}</source>
        <translation>línea de {layer}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>map canvas extent</source>
        <translation>extensión del lienzo del mapa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>no-fly areas of a file</source>
        <translation>zonas de exclusión de un archivo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>no-fly areas of {layer}</source>
        <translation>zonas de exclusión de {layer}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>points of {layer}</source>
        <translation>puntos de {layer}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>polygons of {layer}</source>
        <translation>polígonos de {layer}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>poses of {file}</source>
        <translation>poses de {file}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>set take-off point</source>
        <translation>fijar el punto de despegue</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>single capture</source>
        <translation>captura única</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>text file</source>
        <translation>archivo de texto</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>the area has no polygons</source>
        <translation>no hay ningún área de polígonos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/control.py"/>
        <source>the clipboard holds no text; copy coordinates first</source>
        <translation>el portapapeles no contiene texto; copie antes unas coordenadas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/corners.py"/>
        <source>a hole must lie inside the area</source>
        <translation>un hueco debe estar dentro del área</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/corners.py"/>
        <location filename="../../terrainav_plugin/area/drawing.py"/>
        <source>a polygon needs at least 3 corners</source>
        <translation>un polígono necesita al menos 3 vértices</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/corners.py"/>
        <location filename="../../terrainav_plugin/area/drawing.py"/>
        <source>the outline would cross itself</source>
        <translation>el contorno se cruzaría consigo mismo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>&amp;All</source>
        <translation>&amp;Todos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>&amp;Height above ground</source>
        <translation>Altura so&amp;bre el terreno</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>&amp;Height of all</source>
        <translation>&amp;Altura de todos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>&amp;Interval</source>
        <translation>Inter&amp;valo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>&amp;Layer</source>
        <translation>&amp;Capa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>&amp;Roll from field</source>
        <translation>A&amp;labeo del campo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>&amp;Selected ({n})</source>
        <translation>&amp;Seleccionados ({n})</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>&amp;Tilt from field</source>
        <translation>&amp;Inclinación del campo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>&amp;Unit of heights</source>
        <translation>&amp;Unidad de las alturas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>&amp;Yaw from field</source>
        <translation>&amp;Guiñada del campo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>1 line is selected.</source>
        <translation>Hay 1 línea seleccionada.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>1 polygon is selected.</source>
        <translation>Hay 1 polígono seleccionado.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>All positions of the file, or one per interval of time or distance</source>
        <translation>Todas las posiciones del archivo, o una cada cierto tiempo o distancia</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>An attribute holds each point's height above ground (AGL), in the unit below</source>
        <translation>Un atributo contiene la altura de cada punto sobre el terreno (AGL), en la unidad de abajo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>Begin at the panel's &amp;start</source>
        <translation>Come&amp;nzar en el inicio del panel</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>Click a polygon of this layer on the map; it becomes the area</source>
        <translation>Haga clic en un polígono de esta capa en el mapa; será el área</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>Corners become turns with a radius of {radius} m.</source>
        <translation>Los vértices se convierten en virajes de {radius} m de radio.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>Dates with their times, text such as 2024-06-21T10:30:00Z, or seconds after 1970, in UTC where no zone is stated; empty: they follow from the mission's start and airspeed. Images are in the order of times.</source>
        <translation>Fechas con su hora, texto como 2024-06-21T10:30:00Z, o segundos desde 1970; en UTC si no se indica la zona. Vacío: resultan del inicio y de la velocidad aérea de la misión. Las imágenes siguen el orden de las horas.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>Degrees clockwise from north; empty: the mission's yaw</source>
        <translation>Grados en sentido horario desde el norte; vacío: la guiñada de la propia misión</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>Degrees, right side down; empty: the mission's roll</source>
        <translation>Grados, positivos con el lado derecho hacia abajo; vacío: el alabeo propio de la misión</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>Degrees; empty: the mission's tilt</source>
        <translation>Grados; vacío: la inclinación propia de la misión</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>Features</source>
        <translation>Objetos espaciales</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>Features that become images</source>
        <translation>Objetos espaciales que se convierten en imágenes</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>Give the first position the time of Start; otherwise times are those of the file</source>
        <translation>Dar a la primera posición la hora de Inicio; si no, las horas son las del archivo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>Height above the ground (AGL) in the unit below</source>
        <translation>Altura sobre el terreno (AGL) en la unidad de abajo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>Height above the ground (AGL) of the whole flight</source>
        <translation>Altura sobre el terreno (AGL) de todo el vuelo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>Height from &amp;field</source>
        <translation>Altura del ca&amp;mpo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>Heights are above home, or above the first position. The camera is fixed to the aircraft and looks down, with the top of its image ahead.</source>
        <translation>Las alturas son sobre el punto de partida (home) o sobre la primera posición. La cámara está fija a la aeronave y mira hacia abajo, con el borde superior de la imagen hacia delante.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>Heights of GPX are usually above sea level. The top of each image points in the direction of travel.</source>
        <translation>Las alturas de GPX suelen ser sobre el nivel del mar. El borde superior de cada imagen apunta en el sentido del recorrido.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>Heights of the fi&amp;le, over ground at</source>
        <translation>Alturas del a&amp;rchivo, sobre el terreno a</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>Interval between images; the first is at the beginning</source>
        <translation>Intervalo entre imágenes; la primera está al principio</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>Its only line will be flown.</source>
        <translation>Se volará su única línea.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>Its only polygon will be used.</source>
        <translation>Se usará su único polígono.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>Layer of this project, in any CRS</source>
        <translation>Capa de este proyecto, en cualquier SRC</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>Line of a layer</source>
        <translation>Línea de una capa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>Metres or international feet</source>
        <translation>Metros o pies internacionales</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>Nothing is selected: all {n} lines will be flown one after the other.</source>
        <translation>No hay nada seleccionado: se volarán las {n} líneas, una tras otra.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>Nothing is selected: all {n} polygons are taken.</source>
        <translation>No hay nada seleccionado: se toman los {n} polígonos.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>Numbers above 0, in the unit below</source>
        <translation>Números mayores que 0, en la unidad de abajo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>One image above each point ({crs}).</source>
        <translation>Una imagen sobre cada punto ({crs}).</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>Points of a layer</source>
        <translation>Puntos de una capa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>Polygons</source>
        <translation>Polígonos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>Polygons that are taken, with their holes</source>
        <translation>Polígonos que se toman, con sus huecos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>Poses in metres in a local frame, whose place is not in the file.</source>
        <translation>Poses en metros de un sistema local. El archivo no dice dónde se encuentra este.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>Select on the &amp;map</source>
        <translation>Seleccionar &amp;en el mapa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>The project has no layer of lines: add one, or draw a box instead.</source>
        <translation>El proyecto no tiene ninguna capa de líneas: añada una, o dibuje un recuadro en su lugar.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>The project has no layer of polygons: add one, or draw a polygon instead.</source>
        <translation>El proyecto no tiene ninguna capa de polígonos: añada una o dibuje un polígono.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>The project has no such layer.</source>
        <translation>El proyecto no tiene ninguna capa de este tipo.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>The same height above ground (AGL) for all points</source>
        <translation>La misma altura sobre el terreno (AGL) para todos los puntos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>The smallest box of longitudes and latitudes around it ({crs}), or its rectangle, as a polygon, if the box would be much larger.</source>
        <translation>El menor recuadro de longitudes y latitudes que la contiene ({crs}); su propio rectángulo, como polígono, donde el recuadro sería mucho mayor.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>Ti&amp;me from field</source>
        <translation>&amp;Hora del campo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>Time, or distance flown</source>
        <translation>Tiempo, o distancia volada</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>Where the angle is 0: straight down, or at the horizon</source>
        <translation>Dónde el ángulo es 0: en vertical hacia abajo, o en el horizonte</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>all positions</source>
        <translation>todas las posiciones</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>as in the file</source>
        <translation>como en el archivo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>ft</source>
        <translation>ft</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>gimbal pitch: -90 looks down</source>
        <translation>cabeceo del gimbal: -90 mira hacia abajo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>home</source>
        <translation>punto de partida</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>m</source>
        <translation>m</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>metres</source>
        <translation>metros</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>no CRS</source>
        <translation>sin SRC</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <location filename="../../terrainav_plugin/panel/start.py"/>
        <location filename="../../terrainav_plugin/widgets.py"/>
        <source>not set</source>
        <translation>sin definir</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>seconds</source>
        <translation>segundos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>the origin</source>
        <translation>el origen</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>tilt: 0 looks down</source>
        <translation>inclinación: 0 mira hacia abajo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>{n} lines are selected and will be flown one after the other.</source>
        <translation>Hay {n} líneas seleccionadas, que se volarán una tras otra.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/dialogs.py"/>
        <source>{n} polygons are selected.</source>
        <translation>Hay {n} polígonos seleccionados.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/drawing.py"/>
        <source>outline</source>
        <translation>contorno</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/drawing.py"/>
        <source>this place is outside the map</source>
        <translation>este lugar está fuera del mapa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/editing.py"/>
        <source>clear the no-fly areas</source>
        <translation>quitar las zonas de exclusión</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/editing.py"/>
        <location filename="../../terrainav_plugin/area/entries.py"/>
        <source>make it a box</source>
        <translation>convertir en recuadro</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/editing.py"/>
        <source>paste coordinates</source>
        <translation>pegar coordenadas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/entries.py"/>
        <source>1 no-fly area</source>
        <translation>1 zona de exclusión</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/entries.py"/>
        <source>A number, or degrees, minutes and seconds such as 47 01 30. Coordinates pasted here, or typed and left, fill all fields: north_west_south_east_agl, lat_lon_agl, or lines of lat lon agl [yaw]. An edge typed makes a polygon or points a box.</source>
        <translation>Un número, o grados, minutos y segundos como 47 01 30. Las coordenadas que se pegan aquí, o se escriben y se deja el campo, rellenan todos los campos: north_west_south_east_agl, lat_lon_agl, o líneas de lat lon agl [yaw]. Un borde escrito convierte un polígono o puntos en un recuadro.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/entries.py"/>
        <location filename="../../terrainav_plugin/panel/form.py"/>
        <location filename="../../terrainav_plugin/preview/layers.py"/>
        <source>Area</source>
        <translation>Área</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/entries.py"/>
        <source>Change the area on the map: drag inside it to move it; drag the edges and corners of a box, or the corners of a polygon. Dragging a polygon's edge adds a corner, a right click on a corner or Delete removes it; a right click elsewhere cuts holes and adds polygons. Arrow keys move the area by a pixel of the screen, with Shift by ten; Esc ends it.</source>
        <translation>Cambiar el área en el mapa: arrastre dentro de ella para moverla; arrastre los lados y las esquinas de un recuadro, o los vértices de un polígono. Al arrastrar el lado de un polígono se añade un vértice; un clic derecho sobre un vértice, o Supr, lo quita; un clic derecho en otra parte recorta huecos y añade polígonos. Las flechas mueven el área un píxel de la pantalla, con Mayús diez; Esc termina.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/entries.py"/>
        <source>Draw &amp;box</source>
        <translation>Dib&amp;ujar recuadro</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/entries.py"/>
        <source>Draw a polygon: click each corner on the map; a double click, a right click or Enter finishes, Backspace removes the last corner, Esc cancels</source>
        <translation>Dibujar un polígono: haga clic en cada vértice en el mapa; un doble clic, un clic derecho o Intro termina, Retroceso quita el último vértice y Esc cancela</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/entries.py"/>
        <source>Draw polygon</source>
        <translation>Trazar polígono</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/entries.py"/>
        <source>East</source>
        <translation>Este</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/entries.py"/>
        <source>Eastern edge: longitude in degrees</source>
        <translation>Borde oriental: longitud en grados</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/entries.py"/>
        <source>Edit</source>
        <translation>Editar</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/entries.py"/>
        <source>No change of the area to redo</source>
        <translation>No hay ningún cambio del área que rehacer</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/entries.py"/>
        <source>No change of the area to undo</source>
        <translation>No hay ningún cambio del área que deshacer</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/entries.py"/>
        <source>No image is taken and no leg leads there</source>
        <translation>Allí no se toma ninguna imagen ni pasa ningún tramo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/entries.py"/>
        <location filename="../../terrainav_plugin/panel/entries.py"/>
        <source>North</source>
        <translation>Norte</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/entries.py"/>
        <source>Northern edge: latitude in degrees, up to 90</source>
        <translation>Borde norte: latitud en grados, hasta 90</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/entries.py"/>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>Press, drag and release on the map</source>
        <translation>Pulse, arrastre y suelte en el mapa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/entries.py"/>
        <source>Redo: {step} ({keys})</source>
        <translation>Rehacer: {step} ({keys})</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/entries.py"/>
        <source>Size on the ground: width along its middle parallel, height along a meridian</source>
        <translation>Tamaño sobre el terreno: anchura a lo largo de su paralelo medio, altura a lo largo de un meridiano</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/entries.py"/>
        <source>South</source>
        <translation>Sur</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/entries.py"/>
        <source>Southern edge: latitude in degrees, down to -90</source>
        <translation>Borde sur: latitud en grados, hasta -90</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/entries.py"/>
        <source>The edge typed made it a box; undo brings the shape back.</source>
        <translation>El borde tecleado la ha convertido en un recuadro; deshacer recupera la forma.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/entries.py"/>
        <source>The edges are those of the box around it. Typing one makes the area a box.</source>
        <translation>Los bordes son los del recuadro que la contiene. Al teclear uno, el área pasa a ser un recuadro.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/entries.py"/>
        <source>Undo: {step} ({keys})</source>
        <translation>Deshacer: {step} ({keys})</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/entries.py"/>
        <source>West</source>
        <translation>Oeste</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/entries.py"/>
        <source>Western edge: longitude in degrees; greater than the eastern one across the antimeridian</source>
        <translation>Borde occidental: longitud en grados; mayor que la del borde oriental si el recuadro cruza el antimeridiano</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/entries.py"/>
        <source>degrees</source>
        <translation>grados</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/entries.py"/>
        <source>remove</source>
        <translation>quitar</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/entries.py"/>
        <source>{n} no-fly areas</source>
        <translation>{n} zonas de exclusión</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/history.py"/>
        <source>type the eastern edge</source>
        <translation>teclear el borde oriental</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/history.py"/>
        <source>type the northern edge</source>
        <translation>teclear el borde norte</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/history.py"/>
        <source>type the southern edge</source>
        <translation>teclear el borde sur</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/history.py"/>
        <source>type the western edge</source>
        <translation>teclear el borde occidental</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/layers.py"/>
        <source>Reading the area</source>
        <translation>Leyendo el área</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/layers.py"/>
        <source>The flight misses the corners of its line by up to {missed} m.</source>
        <translation>El vuelo pasa a {missed} m como máximo de los vértices de su línea.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/layers.py"/>
        <source>Tighter turns between short legs: {count}, flown at speeds down to {speed} m/s.</source>
        <translation>Virajes más cerrados, entre tramos cortos: {count}, volados a un mínimo de {speed} m/s.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/layers.py"/>
        <source>area of {count} features</source>
        <translation>área de {count} objetos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/layers.py"/>
        <source>feature {id}</source>
        <translation>objeto {id}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/layers.py"/>
        <source>layer “{name}” is empty: it has no extent</source>
        <translation>la capa «{name}» está vacía: no tiene extensión</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/layers.py"/>
        <source>no lines to fly: select some, or use all lines of the layer</source>
        <translation>no hay ninguna línea que volar: seleccione algunas, o tome todas las de la capa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/layers.py"/>
        <source>no points to use: select some, or use all points of the layer</source>
        <translation>no hay ningún punto que tomar: seleccione algunos, o tome todos los de la capa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/layers.py"/>
        <source>no polygon is selected: select at least one in its layer</source>
        <translation>no hay ningún polígono seleccionado: seleccione al menos uno en su capa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/layers.py"/>
        <source>points</source>
        <translation>puntos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/layers.py"/>
        <source>rectangle</source>
        <translation>rectángulo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/layers.py"/>
        <source>{count} of {total} positions are left out, {reason}.</source>
        <translation>Se omiten {count} de {total} posiciones, {reason}.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/layers.py"/>
        <source>{feature} has a hole around a pole: cut it into parts without one</source>
        <translation>{feature} tiene un hueco alrededor de un polo: córtelo en partes que no lo tengan</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/layers.py"/>
        <source>{feature} has an edge through a pole or across the edge of its map: cut it</source>
        <translation>{feature} tiene un lado que pasa por un polo o cruza el borde de su mapa: córtelo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/layers.py"/>
        <source>{feature} has no geometry: give it a line, or leave it out</source>
        <translation>{feature} no tiene geometría: dele una línea u omítala</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/layers.py"/>
        <source>{feature} has no geometry: give it a point, or leave it out</source>
        <translation>{feature} no tiene geometría: dele un punto u omitirlo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/layers.py"/>
        <source>{feature} has no geometry: select one that has</source>
        <translation>{feature} no tiene geometría: seleccione uno que la tenga</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/layers.py"/>
        <source>{feature} is not a line: choose a layer of lines</source>
        <translation>{feature} no es una línea: tome una capa de líneas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/layers.py"/>
        <source>{feature} is not a point: choose a layer of points</source>
        <translation>{feature} no es un punto: tome una capa de puntos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/layers.py"/>
        <source>{feature} is not a polygon: select one that is</source>
        <translation>{feature} no es un polígono: seleccione uno que lo sea</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/layers.py"/>
        <source>{feature} is not a valid polygon ({what}): repair it first (Processing: Fix geometries)</source>
        <translation>{feature} no es un polígono válido, {what}: repárelo antes (Procesos: Corregir geometrías)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/layers.py"/>
        <source>{feature}: height in “{field}”</source>
        <translation>{feature}: altura en «{field}»</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/layers.py"/>
        <source>{feature}: time in “{field}”</source>
        <translation>{feature}: hora en «{field}»</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/layers.py"/>
        <source>{feature}: {what} in “{field}”</source>
        <translation>{feature}: {what} en «{field}»</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/layers.py"/>
        <source>{feature}: {x}, {y} is outside the domain of {crs}</source>
        <translation>{feature}: {x}, {y} está fuera del dominio de {crs}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/layers.py"/>
        <source>{what} is empty (NULL): must be a number</source>
        <translation>{what} está vacío (NULL): debe ser un número</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/layers.py"/>
        <source>{what} is {value} m: must be above 0</source>
        <translation>{what} es {value} m: debe ser mayor que 0</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/layers.py"/>
        <source>{what} is {value}°: must be from {least} to {most}</source>
        <translation>{what} es {value}°: debe estar entre {least} y {most}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/layers.py"/>
        <source>{what} is “{value}”: must be a number</source>
        <translation>{what} es «{value}»: debe ser un número</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>&amp;Corridor along a line…</source>
        <translation>C&amp;orredor a lo largo de una línea…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <location filename="../../terrainav_plugin/plugin.py"/>
        <source>&amp;Draw box</source>
        <translation>&amp;Dibujar recuadro</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>&amp;Map canvas extent</source>
        <translation>&amp;Extensión del lienzo del mapa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>&amp;Paste coordinates</source>
        <translation>&amp;Pegar coordenadas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>&amp;Single capture here…</source>
        <translation>Captura ú&amp;nica aquí…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>&amp;Text file of points…</source>
        <translation>Archivo de &amp;texto con puntos…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>A line flown at a speed, with images at intervals of time or distance</source>
        <translation>Una línea volada a una velocidad, con imágenes a intervalos de tiempo o de distancia</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <location filename="../../terrainav_plugin/area/tools.py"/>
        <source>Add anoth&amp;er polygon</source>
        <translation>Añadir un polígono &amp;más</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>All polygons of a KML, KMZ or GeoJSON file, with their holes</source>
        <translation>Todos los polígonos de un archivo KML, KMZ o GeoJSON, con sus huecos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>Area &amp;from</source>
        <translation>Área de&amp;sde</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>Area file (KML, Geo&amp;JSON)…</source>
        <translation>Archivo del área (KML, Geo&amp;JSON)…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>Click a point on the map: circles from which the camera looks at it</source>
        <translation>Haga clic en un punto del mapa: círculos desde los que la cámara lo mira</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>Click a point on the map: the mission is one image, straight above it</source>
        <translation>Haga clic en un punto del mapa: la misión es una sola imagen, en su vertical</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <location filename="../../terrainav_plugin/area/no_fly.py"/>
        <source>Click each corner on the map; a double click, a right click or Enter finishes</source>
        <translation>Haga clic en cada vértice en el mapa; un doble clic, un clic derecho o Intro termina</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <location filename="../../terrainav_plugin/area/tools.py"/>
        <source>Cut a &amp;hole</source>
        <translation>Recortar un &amp;hueco</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>Draw a hole inside the area</source>
        <translation>Dibujar un hueco dentro del área</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>Draw one more polygon; what it overlaps is joined with it</source>
        <translation>Dibujar otro polígono; lo que se solape con él se une a él</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <location filename="../../terrainav_plugin/plugin.py"/>
        <source>Draw pol&amp;ygon</source>
        <translation>Tra&amp;zar polígono</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>Extent of a &amp;layer…</source>
        <translation>Extensión de una &amp;capa…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>F&amp;açade along a line…</source>
        <translation>F&amp;achada a lo largo de una línea…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>Flights along a wall, one above the other; the camera looks at it</source>
        <translation>Vuelos a lo largo de un muro, uno encima de otro; la cámara lo mira</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>Flights around a building, one above the other; the camera looks at its walls</source>
        <translation>Vuelos alrededor de un edificio, uno encima de otro; la cámara mira a sus muros</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>From the clipboard: north_west_south_east_agl, lat_lon_agl, lines of lat lon agl [yaw], or a table whose first line names its columns; heights in the unit chosen</source>
        <translation>Del portapapeles: norte_oeste_sur_este_agl, lat_lon_agl, líneas de lat lon agl [guiñada], o una tabla cuya primera línea nombra las columnas; alturas en la unidad elegida</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>Images at random places of the area, with random heights, directions and tilts</source>
        <translation>Imágenes en lugares aleatorios del área, con alturas, direcciones e inclinaciones aleatorias</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>L&amp;ine of a layer…</source>
        <translation>&amp;Línea de una capa…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>Lines of “lat lon agl [yaw]”, in degrees and the unit chosen for the height; or a table whose first line names its columns, such as lat, lon, agl, yaw, tilt, roll, time</source>
        <translation>Líneas de «lat lon agl [guiñada]», en grados y en la unidad elegida para la altura; o una tabla cuya primera línea nombra las columnas, como lat, lon, agl, yaw, tilt, roll, time</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>Make it a &amp;box</source>
        <translation>Convertir en &amp;recuadro</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>O&amp;rbit around a point…</source>
        <translation>Ór&amp;bita alrededor de un punto…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>One image above each point, with height (AGL), attitude and time from fields</source>
        <translation>Una imagen sobre cada punto, con altura (AGL), orientación y hora tomadas de campos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>Other ways to set the area: the map, a layer, a file, the clipboard, a click</source>
        <translation>Otras formas de definir el área: el mapa, una capa, un archivo, el portapapeles, un clic</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>P&amp;oints of a layer…</source>
        <translation>P&amp;untos de una capa…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>Poly&amp;gons of a layer…</source>
        <translation>Polí&amp;gonos de una capa…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>Ra&amp;ndom poses in the area…</source>
        <translation>Poses aleator&amp;ias en el área…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>Rows along a line that show all of a strip</source>
        <translation>Pasadas a lo largo de una línea que muestran toda una franja</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>Str&amp;ucture around a polygon…</source>
        <translation>Estructura: &amp;vuelo alrededor de un polígono…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>The box around a layer</source>
        <translation>El recuadro que contiene una capa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>The box around the polygon or the points, instead of them</source>
        <translation>El recuadro que contiene el polígono o los puntos, en lugar de ellos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>The extent of the map as a box</source>
        <translation>El recuadro de lo que muestra ahora el mapa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>The poses of a GPX track, a PX4 or ArduPilot log, or a TUM, KITTI or EuRoC trajectory: one image from each pose, or one every so many seconds or metres</source>
        <translation>Las poses de un track GPX, de un registro de PX4 o ArduPilot o de una trayectoria TUM, KITTI o EuRoC: una imagen desde cada una, o una cada tantos segundos o metros</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>The selected polygons, or all, with their holes; images that touch none are left out</source>
        <translation>Los polígonos seleccionados, o todos, con sus huecos; las imágenes que no tocan ninguno se omiten</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/menu.py"/>
        <source>Trajectory or &amp;flight log…</source>
        <translation>Tra&amp;yectoria o registro de vuelo…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/no_fly.py"/>
        <source>&amp;Draw no-fly area</source>
        <translation>&amp;Dibujar zona de exclusión</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/no_fly.py"/>
        <source>All polygons of a KML, KMZ or GeoJSON file</source>
        <translation>Todos los polígonos de un archivo KML, KMZ o GeoJSON</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/no_fly.py"/>
        <source>Ground over which no image is taken: drawn, from a layer or from a file</source>
        <translation>Terreno sobre el que no se toma ninguna imagen: dibujado, de una capa o de un archivo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/no_fly.py"/>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <location filename="../../terrainav_plugin/processing/mission_parameters.py"/>
        <source>No-fly areas</source>
        <translation>Zonas de exclusión aérea</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/no_fly.py"/>
        <source>No-fly areas from &amp;file…</source>
        <translation>Zonas de exclusión de un &amp;archivo…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/no_fly.py"/>
        <source>No-fly areas from &amp;layer…</source>
        <translation>Zonas de exclusión de una &amp;capa…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/no_fly.py"/>
        <source>Polygons of a layer, all or those selected</source>
        <translation>Polígonos de una capa, todos o los seleccionados</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/patterns.py"/>
        <source>&amp;Height above ground, from and to</source>
        <translation>&amp;Altura sobre el terreno, desde y hasta</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/patterns.py"/>
        <source>&amp;Images</source>
        <translation>&amp;Imágenes</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/patterns.py"/>
        <source>&amp;Tilt up to</source>
        <translation>&amp;Inclinación hasta</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/patterns.py"/>
        <source>&amp;Within the selected imagery</source>
        <translation>&amp;Dentro de las imágenes seleccionadas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/patterns.py"/>
        <source>Camera and overlaps ({along} %, {across} %) are those of the panel.</source>
        <translation>La cámara y los solapes ({along} %, {across} %) son los del panel.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/patterns.py"/>
        <source>Camera, height ({height}) and overlaps ({along} %, {across} %) are those of the panel.</source>
        <translation>La cámara, la altura ({height}) y los solapes ({along} %, {across} %) son los del panel.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/patterns.py"/>
        <source>Centre of the circles, as clicked on the map</source>
        <translation>Centro de los círculos, el punto pulsado en el mapa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/patterns.py"/>
        <source>Centre, l&amp;atitude and longitude</source>
        <translation>Centro, l&amp;atitud y longitud</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/patterns.py"/>
        <source>Corridor along a line</source>
        <translation>Corredor a lo largo de una línea</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/patterns.py"/>
        <source>Draw only poses from which the panel's camera sees no ground without imagery: other images, such as those at the edge of a raster, fail</source>
        <translation>Sortea solo poses cuya cámara, la del panel, no ve terreno sin imágenes: las imágenes que lo muestran, como en el borde de un ráster, fallan</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/patterns.py"/>
        <source>Façade along a line</source>
        <translation>Fachada a lo largo de una línea</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/patterns.py"/>
        <source>From the l&amp;eft</source>
        <translation>Desde la izqui&amp;erda</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/patterns.py"/>
        <source>Its only feature will be used.</source>
        <translation>Se usará su único objeto.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/patterns.py"/>
        <source>Maximum tilt; the minimum is 0</source>
        <translation>Inclinación máxima; la mínima es 0</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/patterns.py"/>
        <source>Nothing is selected in it: all {n} features are taken.</source>
        <translation>No hay nada seleccionado en ella: se toman todos los objetos ({n}).</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/patterns.py"/>
        <source>Number of images</source>
        <translation>Número de imágenes</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/patterns.py"/>
        <source>Orbit around a point</source>
        <translation>Órbita alrededor de un punto</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/patterns.py"/>
        <source>Places spread evenly over the area, in any direction, with heights and tilts spread evenly between two values.</source>
        <translation>Lugares repartidos por igual en el área, en cualquier dirección, con alturas e inclinaciones repartidas por igual entre dos valores.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/patterns.py"/>
        <source>Random poses in the area</source>
        <translation>Poses aleatorias en el área</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/patterns.py"/>
        <source>Selected features are taken: {n}.</source>
        <translation>Se toman los objetos seleccionados: {n}.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/patterns.py"/>
        <source>Structure around a polygon</source>
        <translation>Estructura alrededor de un polígono</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/patterns.py"/>
        <source>The camera stands to the left of the lines, in their direction; otherwise to their right</source>
        <translation>La cámara está a la izquierda de las líneas, en su sentido; si no, a su derecha</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/patterns.py"/>
        <source>no area to draw poses in: draw a box or a polygon first</source>
        <translation>no hay un área para las poses: dibuje antes un recuadro o un polígono</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/patterns.py"/>
        <source>the camera is not complete: fix its fields in the panel first</source>
        <translation>la cámara no está completa: corrija antes sus campos en el panel</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/tools.py"/>
        <source>&amp;Remove this hole</source>
        <translation>&amp;Quitar este hueco</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/tools.py"/>
        <source>Add a &amp;corner here</source>
        <translation>Añadir un &amp;vértice aquí</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/tools.py"/>
        <source>Make it a &amp;polygon</source>
        <translation>Convertir en &amp;polígono</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/tools.py"/>
        <source>Re&amp;move this polygon</source>
        <translation>Quitar este políg&amp;ono</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/tools.py"/>
        <source>Set &amp;take-off point here</source>
        <translation>Fijar aquí el punto de &amp;despegue</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/tools.py"/>
        <source>The outline would cross itself</source>
        <translation>El contorno se cruzaría consigo mismo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/tools.py"/>
        <source>add a corner</source>
        <translation>añadir un vértice</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/tools.py"/>
        <source>drag an edge</source>
        <translation>arrastrar un borde</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/tools.py"/>
        <source>make it a polygon</source>
        <translation>convertir en polígono</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/tools.py"/>
        <source>move a corner</source>
        <translation>mover un vértice</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/tools.py"/>
        <source>move by arrow keys</source>
        <translation>mover con las teclas de flecha</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/tools.py"/>
        <source>move the area</source>
        <translation>mover el área</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/tools.py"/>
        <source>remove a corner</source>
        <translation>quitar un vértice</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/tools.py"/>
        <source>remove a hole</source>
        <translation>quitar un hueco</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/area/tools.py"/>
        <source>remove a polygon</source>
        <translation>quitar un polígono</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/endings.py"/>
        <source>Capture only the failed ones</source>
        <translation>Capturar solo las fallidas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/endings.py"/>
        <source>Ideal test shot {lat} {lon}</source>
        <translation>Toma de prueba ideal {lat} {lon}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/endings.py"/>
        <source>Its SHA-256 begins with {digest}; {image} shows it. It may be water or snow. If it shows no imagery, “Treat as missing” removes the images with it and requests its places again; the options list such tiles.</source>
        <translation>Su SHA-256 empieza por {digest}; {image} la muestra. Puede ser agua o nieve. Si no muestra imágenes, «Tratar como ausente» elimina las imágenes que la contienen y vuelve a pedir sus lugares; las opciones enumeran lo que se trata así.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/endings.py"/>
        <source>Its project is closed.</source>
        <translation>Su proyecto está cerrado.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/endings.py"/>
        <source>Open dataset</source>
        <translation>Abrir el conjunto de datos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/endings.py"/>
        <location filename="../../terrainav_plugin/dataset_window/cleaning.py"/>
        <location filename="../../terrainav_plugin/dataset_window/export_tab.py"/>
        <location filename="../../terrainav_plugin/missions/plan_export.py"/>
        <source>Open folder</source>
        <translation>Abrir carpeta</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/endings.py"/>
        <location filename="../../terrainav_plugin/capture/queue.py"/>
        <source>Resume</source>
        <translation>Reanudar</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/endings.py"/>
        <source>Test shot {lat} {lon}</source>
        <translation>Toma de prueba {lat} {lon}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/endings.py"/>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>Treat as missing</source>
        <translation>Tratar como ausente</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/endings.py"/>
        <source>Without a mosaic: {reason}. “View images” shows them one by one.</source>
        <translation>Sin mosaico: {reason}. «Ver imágenes» las muestra una a una.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/endings.py"/>
        <source>in an earlier run</source>
        <translation>en una ejecución anterior</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/endings.py"/>
        <source>{name}: stopped before the first image.</source>
        <translation>{name}: detenida antes de la primera imagen.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/endings.py"/>
        <source>{name}: stopped with {there} of {total} images.</source>
        <translation>{name}: detenida con {there} de {total} imágenes.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/endings.py"/>
        <source>{name}: stopped without the mosaic, with {there} of {total} images.</source>
        <translation>{name}: detenida sin el mosaico, con {there} de {total} imágenes.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/endings.py"/>
        <source>{name}: the same tile came for {places} places and is in {images} images.</source>
        <translation>{name}: la misma tesela llegó para {places} lugares y está en {images} imágenes.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/endings.py"/>
        <source>{name}: there will be no mosaic: {reason}. Its images are captured all the same.</source>
        <translation>{name}: no habrá mosaico: {reason}. Sus imágenes se capturan de todos modos.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/endings.py"/>
        <source>{name}: {failed} of {total} images could not be captured ({reason}).</source>
        <translation>{name}: no se pudieron capturar {failed} de {total} imágenes ({reason}).</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/questions.py"/>
        <source>Capture into {name}</source>
        <translation>Capturar en {name}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/questions.py"/>
        <source>Do you agree to these terms, and are you allowed to download?</source>
        <translation>¿Acepta estas condiciones y tiene permiso para descargar?</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/questions.py"/>
        <location filename="../../terrainav_plugin/session.py"/>
        <source>Nothing to capture yet.</source>
        <translation>Aún no hay nada que capturar.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/questions.py"/>
        <source>Terms and alternatives</source>
        <translation>Condiciones y alternativas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/questions.py"/>
        <source>TerrAInav: terms of the source</source>
        <translation>TerrAInav: condiciones de la fuente</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/questions.py"/>
        <source>no folder: choose where to save the images</source>
        <translation>no hay carpeta: elija dónde guardar las imágenes</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/questions.py"/>
        <source>{folder} holds another mission; nothing was changed there.</source>
        <translation>{folder} contiene otra misión; no se ha cambiado nada en ella.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/questions.py"/>
        <source>{folder}: a capture into it is already running; a second mission needs another folder.</source>
        <translation>{folder}: ya hay una captura en curso en ella; una segunda misión necesita su propia carpeta.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/questions.py"/>
        <source>{name} is already being captured.</source>
        <translation>{name} ya se está capturando.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/queue.py"/>
        <source>Forget (files are kept)</source>
        <translation>Olvidar (se conservan los archivos)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/queue.py"/>
        <source>No test shot.</source>
        <translation>Sin toma de prueba.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/queue.py"/>
        <source>Nothing captured: {reason}</source>
        <translation>No se ha capturado nada: {reason}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/queue.py"/>
        <source>stopped</source>
        <translation>detenida</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/queue.py"/>
        <source>{name}: cannot be captured: {reason}</source>
        <translation>{name}: no se puede capturar: {reason}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/queue.py"/>
        <source>{name}: cannot be resumed: {reason}</source>
        <translation>{name}: no se puede reanudar: {reason}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/queue.py"/>
        <source>{name}: its capture did not end.</source>
        <translation>{name}: su captura no terminó.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/queue.py"/>
        <source>{name}: its capture did not end: {there} of {total} images.</source>
        <translation>{name}: su captura no terminó: {there} de {total} imágenes.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/run.py"/>
        <source>, {failed} failed</source>
        <translation>, {failed} fallidas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/run.py"/>
        <source>, {rate} a second, {time} left</source>
        <translation>, {rate} por segundo, quedan {time}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/run.py"/>
        <source>; making the mosaic, {time} left</source>
        <translation>; creando el mosaico, quedan {time}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/run.py"/>
        <source>All {total} images already exist.</source>
        <translation>Las {total} imágenes ya existen.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/run.py"/>
        <source>All {total} images captured: {written} now, in {time}; {skipped} in earlier runs.</source>
        <translation>Las {total} imágenes están: {written} capturadas ahora en {time}, {skipped} antes.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/run.py"/>
        <source>Missing: {failed} of {total} images</source>
        <translation>Faltan: {failed} de {total} imágenes</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/run.py"/>
        <source>No images were missing.</source>
        <translation>No faltaba ninguna imagen.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/run.py"/>
        <source>One image captured in {time}.</source>
        <translation>Una imagen capturada en {time}.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/run.py"/>
        <source>Paused</source>
        <translation>En pausa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/run.py"/>
        <source>Paused: {counts}</source>
        <translation>En pausa: {counts}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/run.py"/>
        <source>Reading heights…</source>
        <translation>Leyendo alturas…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/run.py"/>
        <source>Starting…</source>
        <translation>Empezando…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/run.py"/>
        <source>Stopped before the first image</source>
        <translation>Detenida antes de la primera imagen</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/run.py"/>
        <source>Stopped with {there} of {total} images</source>
        <translation>Detenida con {there} de {total} imágenes</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/run.py"/>
        <source>Stopped without the mosaic, with {there} of {total} images</source>
        <translation>Detenida sin el mosaico, con {there} de {total} imágenes</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/run.py"/>
        <source>Stopped; making the mosaic…</source>
        <translation>Detenida; haciendo el mosaico…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/run.py"/>
        <source>Stopping…</source>
        <translation>Deteniendo…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/run.py"/>
        <location filename="../../terrainav_plugin/panel/dock.py"/>
        <source>Test shot</source>
        <translation>Toma de prueba</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/run.py"/>
        <source>The image already exists.</source>
        <translation>La imagen ya existe.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/run.py"/>
        <source>Waiting: next</source>
        <translation>En espera: la siguiente</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/run.py"/>
        <source>Waiting: {place} ahead of it</source>
        <translation>En espera: {place} por delante</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/run.py"/>
        <source>{done} of {total} images</source>
        <translation>{done} de {total} imágenes</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/run.py"/>
        <source>{error} (the images were saved)</source>
        <translation>{error} (las imágenes están guardadas)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/run.py"/>
        <source>{name}: failed images</source>
        <translation>{name}: imágenes fallidas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/run.py"/>
        <source>{written} images captured in {time}.</source>
        <translation>{written} imágenes capturadas en {time}.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/task.py"/>
        <source>Capturing {name}</source>
        <translation>Capturando {name}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/unfinished.py"/>
        <source>Looking for captures that have not ended</source>
        <translation>Buscando capturas que no han terminado</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/unfinished.py"/>
        <source>Planning</source>
        <translation>Planificando</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/unfinished.py"/>
        <source>The capture could not be noted: {error}</source>
        <translation>No se pudo anotar la captura: {error}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/capture/unfinished.py"/>
        <source>{path}: a note of a capture cannot be read ({error})</source>
        <translation>{path}: no se puede leer la nota de una captura ({error})</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/credentials.py"/>
        <source>API key: choose a configuration, or press “+” and enter it as password</source>
        <translation>Clave API: elija una configuración, o pulse «+» e introdúzcala como contraseña</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/credentials.py"/>
        <source>QGIS's authentication database cannot be used: {reason}</source>
        <translation>No se puede usar la base de datos de autenticación de QGIS: {reason}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/credentials.py"/>
        <source>QGIS's authentication database is locked: press Capture again and enter its master password</source>
        <translation>La base de datos de autenticación de QGIS está bloqueada: pulse Capturar de nuevo e introduzca su contraseña maestra</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/credentials.py"/>
        <source>TerrAInav: {title}</source>
        <translation>TerrAInav: {title}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/credentials.py"/>
        <source>authentication configuration {id} does not exist (any more): choose another</source>
        <translation>la configuración de autenticación {id} no existe (o ya no existe): elija otra</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/credentials.py"/>
        <source>authentication configuration {id} holds no key: choose a Basic one with the key as password</source>
        <translation>la configuración de autenticación {id} no contiene ninguna clave: elija una de autenticación básica con la clave como contraseña</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/footprints.py"/>
        <source>cannot draw in the map's CRS ({reason})</source>
        <translation>en el SRC del mapa no se puede dibujar ({reason})</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/footprints.py"/>
        <source>footprints {path}: cannot be read ({reason})</source>
        <translation>huellas {path}: no se pueden leer ({reason})</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/footprints.py"/>
        <location filename="../../terrainav_plugin/dataset_window/marks.py"/>
        <location filename="../../terrainav_plugin/remote/geoparquet.py"/>
        <source>footprints: stopped</source>
        <translation>huellas: detenido</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/footprints.py"/>
        <source>it has changed</source>
        <translation>ha cambiado</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/footprints.py"/>
        <source>it was not written by a capture</source>
        <translation>no es de ninguna captura</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/layers.py"/>
        <location filename="../../terrainav_plugin/processing/capture.py"/>
        <source>Captured images</source>
        <translation>Imágenes capturadas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/layers.py"/>
        <source>Failed images</source>
        <translation>Imágenes fallidas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/mosaic.py"/>
        <source>Roadmap images</source>
        <translation>Imágenes de callejero</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/mosaic.py"/>
        <source>Satellite images</source>
        <translation>Imágenes de satélite</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/mosaic.py"/>
        <source>Terrain images</source>
        <translation>Imágenes de relieve</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/mosaic.py"/>
        <source>{title}, part {number}</source>
        <translation>{title}, parte {number}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/overlay.py"/>
        <source>The labels cannot be read: {reason}</source>
        <translation>No se pueden leer las etiquetas: {reason}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/overlay.py"/>
        <source>There are no labels (yet).</source>
        <translation>(Aún) no hay etiquetas.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/overlay.py"/>
        <source>background</source>
        <translation>fondo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/overlay.py"/>
        <source>feature {number} of {layer}</source>
        <translation>elemento {number} de {layer}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/overlay.py"/>
        <location filename="../../terrainav_plugin/plan_features.py"/>
        <source>ignore</source>
        <translation>ignorar</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/overlay.py"/>
        <source>instance {number}</source>
        <translation>instancia {number}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/overlay.py"/>
        <source>{file}: holds no whole numbers from 0</source>
        <translation>{file}: no contiene números enteros a partir de 0</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/picture.py"/>
        <source>The depth cannot be read: {reason}</source>
        <translation>No se puede leer la profundidad: {reason}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/picture.py"/>
        <source>The image cannot be read: {reason}</source>
        <translation>No se puede leer la imagen: {reason}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/picture.py"/>
        <source>There is no image (yet).</source>
        <translation>No hay imagen (todavía).</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/placing.py"/>
        <source>Open the image ({map_type})</source>
        <translation>Abrir la imagen ({map_type})</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/placing.py"/>
        <source>yaw, tilt, roll: {angles}</source>
        <translation>guiñada, inclinación, alabeo: {angles}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/rectify.py"/>
        <source>image {name}: is not in the dataset, or is rejected</source>
        <translation>imagen {name}: no está en el conjunto de datos, o está rechazada</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/scores.py"/>
        <source>1 to 3 m</source>
        <translation>1 a 3 m</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/scores.py"/>
        <source>10 to 20 m</source>
        <translation>10 a 20 m</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/scores.py"/>
        <source>3 to 5 m</source>
        <translation>3 a 5 m</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/scores.py"/>
        <source>5 to 10 m</source>
        <translation>5 a 10 m</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/scores.py"/>
        <source>Error (metres)</source>
        <translation>Error (metros)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/scores.py"/>
        <source>Error of the attitude (degrees)</source>
        <translation>Error de la actitud (grados)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/scores.py"/>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <location filename="../../terrainav_plugin/panel/form.py"/>
        <location filename="../../terrainav_plugin/panel/imagery.py"/>
        <source>Imagery</source>
        <translation>Fuente de imágenes</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/scores.py"/>
        <source>Latitude of the answer</source>
        <translation>Latitud de la respuesta</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/scores.py"/>
        <source>Longitude of the answer</source>
        <translation>Longitud de la respuesta</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/scores.py"/>
        <source>Query</source>
        <translation>Consulta</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/scores.py"/>
        <source>Rank of the first right tile</source>
        <translation>Puesto de la primera tesela correcta</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/scores.py"/>
        <source>error: {error}</source>
        <translation>error: {error}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/scores.py"/>
        <source>more than 20 m</source>
        <translation>más de 20 m</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/scores.py"/>
        <source>not answered</source>
        <translation>sin respuesta</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/scores.py"/>
        <source>up to 1 m</source>
        <translation>hasta 1 m</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <source>Automatic: blocks where images overlap</source>
        <translation>Automático: bloques donde las imágenes se solapan</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <source>Block size (metres)</source>
        <translation>Tamaño de los bloques (metros)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <source>Blocks of ground</source>
        <translation>Bloques de terreno</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <source>By a hash of seed and name, in the table's order, or by blocks of ground, as overlapping images need.</source>
        <translation>Por un hash de la semilla y el nombre, en el orden de la tabla, o por bloques de terreno, como necesitan las imágenes que se solapan.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <source>Frame of the labels</source>
        <translation>Sistema de las etiquetas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <source>Gap between parts (metres)</source>
        <translation>Separación entre partes (metros)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <source>In the order of the table</source>
        <translation>En el orden de la tabla</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <source>Nothing is changed.</source>
        <translation>No se cambia nada.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <source>Nothing to undo: the dataset is not split.</source>
        <translation>Nada que deshacer: el conjunto de datos no está dividido.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Only count</source>
        <translation>Solo contar</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <source>Plane about the middle</source>
        <translation>Plano en torno al centro</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <source>Restores the parts and labels before the last split, or removes both if there were none.</source>
        <translation>Restaura las partes y las etiquetas anteriores a la última división, o las quita si no había.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <source>Seed</source>
        <translation>Semilla</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <source>Share of test</source>
        <translation>Proporción de prueba</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <source>Share of training</source>
        <translation>Proporción de entrenamiento</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <source>Share of validation</source>
        <translation>Proporción de validación</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <source>Shuffled</source>
        <translation>Al azar</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <source>Splitting method</source>
        <translation>Método de división</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <source>Test</source>
        <translation>Prueba</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <source>The images lie in {count} UTM zones ({zones}); one frame covers them all: {frame}.</source>
        <translation>Las imágenes están en {count} zonas UTM ({zones}); un solo sistema sirve para todas: {frame}.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <source>The same seed gives the same split.</source>
        <translation>La misma semilla da la misma división.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <source>The split is undone. Parts before it: {parts}.</source>
        <translation>División deshecha. Partes anteriores: {parts}.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <source>The split is undone: the images are in no part, and there are no labels.</source>
        <translation>La división está deshecha: las imágenes no están en ninguna parte y no hay etiquetas.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <source>The three shares add up to 1.</source>
        <translation>Las tres proporciones suman 1.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <source>Training</source>
        <translation>Entrenamiento</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <source>UTM zone of the middle</source>
        <translation>Zona UTM del centro</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <source>Undo the last split</source>
        <translation>Deshacer la última división</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <source>Validation</source>
        <translation>Validación</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <source>Web Mercator</source>
        <translation>Web Mercator</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <source>With blocks only. If empty, a size is found that gives parts close to the shares.</source>
        <translation>Solo con bloques; vacío busca uno que se acerque a las proporciones.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <source>With blocks only: minimum distance between the ground of two parts.</source>
        <translation>Solo con bloques: distancia mínima entre el terreno de dos partes.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <source>utm, mercator, mission, or a projected system in metres such as EPSG:32616.</source>
        <translation>utm, mercator, mission o un sistema proyectado en metros como EPSG:32616.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <source>{images} images are in no part: they see the horizon or a pole.</source>
        <translation>{images} imágenes no están en ninguna parte: ven el horizonte o un polo.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <source>{images} images are in no part: too near to another part's ground.</source>
        <translation>{images} imágenes no están en ninguna parte: demasiado cerca del terreno de otra parte.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <source>{part}: {images} images ({share} %).</source>
        <translation>{part}: {images} imágenes ({share} %).</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/splitting.py"/>
        <source>{share} % of the test images see ground of the training part: blocks leave none.</source>
        <translation>El {share} % de las imágenes de prueba ve terreno de la parte de entrenamiento: con bloques no lo ve ninguna.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/benchmark_tab.py"/>
        <source>A benchmark has images from one imagery, the queries, to find in another, the reference, with the right answers. The queries are the images of the mission in the panel.</source>
        <translation>Un banco de pruebas contiene imágenes de una fuente, las consultas, que hay que encontrar en otra, la referencia, y las respuestas correctas. Las consultas son las imágenes de la misión del panel.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/benchmark_tab.py"/>
        <source>Make benchmark…</source>
        <translation>Crear banco de pruebas…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/benchmark_tab.py"/>
        <source>Open Processing's window with the panel's mission</source>
        <translation>Abrir la ventana de Procesos con la misión del panel</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/benchmark_tab.py"/>
        <source>Open Processing's window with this benchmark</source>
        <translation>Abrir la ventana de Procesos con este banco de pruebas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/benchmark_tab.py"/>
        <source>Score benchmark…</source>
        <translation>Puntuar banco de pruebas…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/benchmark_tab.py"/>
        <source>This folder is a benchmark of {count} queries.</source>
        <translation>Esta carpeta es un banco de pruebas de {count} consultas.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/benchmark_tab.py"/>
        <location filename="../../terrainav_plugin/dataset_window/export_tab.py"/>
        <source>This folder is not a benchmark.</source>
        <translation>Esta carpeta no es un banco de pruebas.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/benchmark_tab.py"/>
        <source>To score a benchmark, run a baseline or read your own predictions: how many queries are found, how far off they are, and where on the map.</source>
        <translation>Para puntuar un banco de pruebas, ejecute un método de referencia o lea sus propias predicciones: cuántas consultas se encuentran, con qué error y en qué lugar del mapa.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/charts.py"/>
        <source>Drag the line: images with less entropy (bits) are rejected.
Arrow keys move it by {step}, with Shift by {shift}, Page keys by {page} bits.</source>
        <translation>Arrastrar la línea: se rechazan las imágenes con menos entropía (bits).
Las flechas la mueven {step}, con Mayús {shift}, y las teclas de página {page} bits.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/charts.py"/>
        <source>Entropy (bits)</source>
        <translation>Entropía (bits)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/charts.py"/>
        <source>Image, in the order of the flight</source>
        <translation>Imagen, en el orden del vuelo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/charts.py"/>
        <location filename="../../terrainav_plugin/dataset_window/labels_tab.py"/>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Images</source>
        <translation>Imágenes</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/charts.py"/>
        <source>Threshold {bits} bits</source>
        <translation>Umbral {bits} bits</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/charts.py"/>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>{bits} bits</source>
        <translation>{bits} bits</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/clean_tab.py"/>
        <source> bits</source>
        <translation> bits</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/clean_tab.py"/>
        <source>&amp;Image by image</source>
        <translation>&amp;Imagen por imagen</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/clean_tab.py"/>
        <source>&amp;Threshold</source>
        <translation>Umbra&amp;l</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/clean_tab.py"/>
        <source>&lt;b&gt;{kept}&lt;/b&gt; of {count} images kept, &lt;b&gt;{rejected}&lt;/b&gt; rejected ({percent} %)</source>
        <translation>&lt;b&gt;{kept}&lt;/b&gt; de {count} imágenes se conservan, &lt;b&gt;{rejected}&lt;/b&gt; se rechazan ({percent} %)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/clean_tab.py"/>
        <source>Cleaned before: {marked} images marked, {moved} files moved away.</source>
        <translation>Limpiado antes: {marked} imágenes marcadas, {moved} archivos apartados.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/clean_tab.py"/>
        <source>Histo&amp;gram</source>
        <translation>Hi&amp;stograma</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/clean_tab.py"/>
        <source>Images with less entropy are rejected. 0 bits: a single grey; 8 bits: the maximum</source>
        <translation>Se rechazan las imágenes con menos entropía: 0 bits es un solo gris, 8 bits lo máximo que puede haber</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/clean_tab.py"/>
        <source>Just above: kept</source>
        <translation>Justo por encima: se conservan</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/clean_tab.py"/>
        <source>Just below: rejected</source>
        <translation>Justo por debajo: se rechazan</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/clean_tab.py"/>
        <source>Map t&amp;ype</source>
        <translation>&amp;Tipo de mapa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/clean_tab.py"/>
        <source>Map type shown here; cleaning applies this threshold to all map types</source>
        <translation>Tipo de mapa que se muestra; se limpian todos los tipos de mapa, cada uno con este umbral</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/clean_tab.py"/>
        <source>Mar&amp;k</source>
        <translation>M&amp;arcar</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/clean_tab.py"/>
        <source>Mark on the map the images that would be rejected</source>
        <translation>Marcar en el mapa las imágenes que se rechazarían</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/clean_tab.py"/>
        <source>Mark rejected images, and move their files to a folder “rejected” beside the others</source>
        <translation>Marcar las imágenes rechazadas y mover sus archivos a una carpeta «rejected» junto a las demás</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/clean_tab.py"/>
        <source>Move &amp;away</source>
        <translation>A&amp;partar</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/clean_tab.py"/>
        <source>Not cleaned yet.</source>
        <translation>Sin limpiar todavía.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/clean_tab.py"/>
        <source>On the map</source>
        <translation>En el mapa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/clean_tab.py"/>
        <source>Reject low-detail images: note in the dataset's table which are rejected, and why</source>
        <translation>Rechazar las imágenes con poco detalle: anotar en la tabla del conjunto de datos cuáles se rechazan y por qué</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/clean_tab.py"/>
        <source>Remove all marks and move all files back</source>
        <translation>Quitar todas las marcas y devolver todos los archivos a su sitio</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/clean_tab.py"/>
        <source>S&amp;uggest</source>
        <translation>S&amp;ugerir</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/clean_tab.py"/>
        <source>Save charts…</source>
        <translation>Guardar gráficos…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/clean_tab.py"/>
        <source>That is a large part: look at the images below before you reject them.</source>
        <translation>Es una parte grande: mire las imágenes de abajo antes de rechazarlas.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/clean_tab.py"/>
        <source>The entropies form one group: nothing stands out, and the threshold stays as it is. Cut in two at {bits} bits (Otsu's method, the dotted line), {rejected} of {count} images ({percent} %) would be rejected, which may all be good.</source>
        <translation>Las entropías forman un solo grupo: nada destaca, y el umbral queda como está. Al partirlo en dos en {bits} bits (método de Otsu, la línea de puntos) se rechazarían {rejected} de {count} imágenes ({percent} %), que pueden ser todas buenas.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/clean_tab.py"/>
        <source>The entropies form two groups with few images between them; {bits} bits separate them best (Otsu's method). The lower group has {rejected} of {count} images ({percent} %).</source>
        <translation>Las entropías forman dos grupos con pocas imágenes entre ellos; {bits} bits es lo que mejor los separa (método de Otsu). El grupo inferior tiene {rejected} de {count} imágenes ({percent} %).</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/clean_tab.py"/>
        <source>The roadmap decides for all of them.</source>
        <translation>Para todas decide el callejero.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/clean_tab.py"/>
        <source>The roadmap decides for {count} of them.</source>
        <translation>Para {count} de ellas decide el callejero.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/clean_tab.py"/>
        <source>This dataset has no footprints: it cannot be shown on the map.</source>
        <translation>Este conjunto de datos no tiene huellas: no se puede mostrar en el mapa.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/clean_tab.py"/>
        <source>Threshold that best separates the entropies into two groups (Otsu's method, the dotted line), and how many images it rejects</source>
        <translation>Umbral que mejor separa las entropías en dos grupos (método de Otsu, la línea de puntos), y cuántas imágenes rechaza</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/clean_tab.py"/>
        <source>U&amp;ndo</source>
        <translation>Des&amp;hacer</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/clean_tab.py"/>
        <source>Write both charts of every map type as PNG; needs the Python package matplotlib</source>
        <translation>Escribir los dos gráficos de cada tipo de mapa en PNG; necesita el paquete de Python matplotlib</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/clean_tab.py"/>
        <location filename="../../terrainav_plugin/processing/windows.py"/>
        <source>{count} images could not be captured.</source>
        <translation>No se pudieron capturar {count} imágenes.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/clean_tab.py"/>
        <source>{name}
{bits} bits; press to show it on the map</source>
        <translation>{name}
{bits} bits; pulse para verla en el mapa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/cleaning.py"/>
        <location filename="../../terrainav_plugin/dataset_window/export_tab.py"/>
        <location filename="../../terrainav_plugin/dataset_window/labels_tab.py"/>
        <location filename="../../terrainav_plugin/dataset_window/split_tab.py"/>
        <source>Reading {name}…</source>
        <translation>Leyendo {name}…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/cleaning.py"/>
        <source>TerrAInav: folder for the charts</source>
        <translation>TerrAInav: carpeta para los gráficos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/cleaning.py"/>
        <source>Update mosaic</source>
        <translation>Actualizar mosaico</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/cleaning.py"/>
        <source>{count} charts written to {folder}.</source>
        <translation>{count} gráficos escritos en {folder}.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/cleaning.py"/>
        <source>{name}: stopped. Press the button again to finish, or Undo to put all back.</source>
        <translation>{name}: detenido. Pulsar otra vez el botón para terminar, o Deshacer para devolverlo todo a su sitio.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/export_tab.py"/>
        <location filename="../../terrainav_plugin/dataset_window/labels_tab.py"/>
        <source>All</source>
        <translation>Todas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/export_tab.py"/>
        <source>Any dataset</source>
        <translation>Cualquier conjunto de datos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/export_tab.py"/>
        <location filename="../../terrainav_plugin/processing/algorithm.py"/>
        <source>Benchmarks</source>
        <translation>Bancos de pruebas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/export_tab.py"/>
        <source>Camera frames</source>
        <translation>Imágenes de cámara</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/export_tab.py"/>
        <source>E&amp;xport</source>
        <translation>E&amp;xportar</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/export_tab.py"/>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Folder of the export</source>
        <translation>Carpeta de la exportación</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/export_tab.py"/>
        <source>Labels of pixels</source>
        <translation>Etiquetas de píxeles</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/export_tab.py"/>
        <location filename="../../terrainav_plugin/dataset_window/labels_tab.py"/>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Map type</source>
        <translation>Tipo de mapa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/export_tab.py"/>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>New or empty; if left out, parquet, croissant and stac are written into the dataset's folder.</source>
        <translation>Que aún no exista o esté vacía; si se omite, parquet, croissant y stac van a la del propio conjunto de datos.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/export_tab.py"/>
        <source>Sequences</source>
        <translation>Secuencias</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/export_tab.py"/>
        <source>Show what was written</source>
        <translation>Mostrar lo que se ha escrito</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/export_tab.py"/>
        <source>Stopped: nothing of the export is left.</source>
        <translation>Detenido: no queda nada de la exportación.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/export_tab.py"/>
        <source>TerrAInav: folder of the export</source>
        <translation>TerrAInav: carpeta de la exportación</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/export_tab.py"/>
        <source>The one to export, of several</source>
        <translation>De varios, el que se exporta</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/export_tab.py"/>
        <source>This folder has no labels of pixels.</source>
        <translation>Esta carpeta no tiene etiquetas de píxeles.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/export_tab.py"/>
        <source>This folder is not a sequence.</source>
        <translation>Esta carpeta no es una secuencia.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/export_tab.py"/>
        <source>Write the dataset in this format</source>
        <translation>Escribir el conjunto de datos en este formato</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/export_tab.py"/>
        <source>{count} files as {format} in {folder}.</source>
        <translation>{count} archivos como {format} en {folder}.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/export_tab.py"/>
        <source>{count} images as {format} in {folder}.</source>
        <translation>{count} imágenes como {format} en {folder}.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/export_tab.py"/>
        <source>{count} images as {format} in {folder}; the image files stay where they are.</source>
        <translation>{count} imágenes como {format} en {folder}; los archivos de imagen quedan donde están.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/export_tab.py"/>
        <source>{count} queries as {format} in {folder}.</source>
        <translation>{count} consultas como {format} en {folder}.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/labels_tab.py"/>
        <source>&lt; Previous</source>
        <translation>&lt; Anteriores</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/labels_tab.py"/>
        <source>A label is the position of the image's centre, scaled by labels.json: metres in {frame} minus the mean, in standard deviations of {count} images.</source>
        <translation>Una etiqueta es la posición del centro de la imagen, escalada según labels.json: metros de {frame} menos la media, en desviaciones típicas de {count} imágenes.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/labels_tab.py"/>
        <source>Depth along the optical axis, in colours on a logarithmic scale</source>
        <translation>Profundidad a lo largo del eje óptico; los colores siguen su logaritmo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/labels_tab.py"/>
        <source>Depth: {range}</source>
        <translation>Profundidad: {range}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/labels_tab.py"/>
        <source>Entropy: {bits} bits</source>
        <translation>Entropía: {bits} bits</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/labels_tab.py"/>
        <source>Images after these</source>
        <translation>Imágenes posteriores</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/labels_tab.py"/>
        <source>Images before these</source>
        <translation>Imágenes anteriores</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/labels_tab.py"/>
        <source>In no part (gap)</source>
        <translation>En ninguna parte (separación)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/labels_tab.py"/>
        <source>Label: easting {east}, northing {north}</source>
        <translation>Etiqueta: este {east}, norte {north}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/labels_tab.py"/>
        <source>Map type shown here</source>
        <translation>Tipo de mapa que se muestra aquí</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/labels_tab.py"/>
        <source>Next &gt;</source>
        <translation>Siguientes &gt;</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/labels_tab.py"/>
        <source>No images.</source>
        <translation>No hay imágenes.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/labels_tab.py"/>
        <source>No labels yet: a split writes them.</source>
        <translation>Aún no hay etiquetas: las escribe una división.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/labels_tab.py"/>
        <source>Not rejected</source>
        <translation>No rechazada</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/labels_tab.py"/>
        <source>Part: {part}</source>
        <translation>Parte: {part}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/labels_tab.py"/>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>Rejected</source>
        <translation>Rechazada</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/labels_tab.py"/>
        <source>Rejected: {reason}</source>
        <translation>Rechazada: {reason}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/labels_tab.py"/>
        <source>Which images are shown: all, or those of a part of the split</source>
        <translation>Qué imágenes se muestran: todas, o las de una parte de la división</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/labels_tab.py"/>
        <source>no ground</source>
        <translation>sin terreno</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/labels_tab.py"/>
        <location filename="../../terrainav_plugin/form/headings.py"/>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>none</source>
        <translation>ninguna</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/labels_tab.py"/>
        <source>none (gap)</source>
        <translation>ninguna (separación)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/labels_tab.py"/>
        <source>{depth} m</source>
        <translation>{depth} m</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/labels_tab.py"/>
        <source>{first} to {last} of {total}</source>
        <translation>{first} a {last} de {total}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/split_tab.py"/>
        <source>Not split yet: {count} images.</source>
        <translation>Aún sin dividir: {count} imágenes.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/split_tab.py"/>
        <source>Only counted, nothing was changed: {how}.</source>
        <translation>Solo se ha contado, nada ha cambiado: {how}.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/split_tab.py"/>
        <source>Parts now: {parts}.</source>
        <translation>Partes actuales: {parts}.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/split_tab.py"/>
        <location filename="../../terrainav_plugin/dataset_window/window.py"/>
        <source>Split</source>
        <translation>Dividir</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/split_tab.py"/>
        <source>Stopped: nothing was changed.</source>
        <translation>Detenido: nada ha cambiado.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/split_tab.py"/>
        <source>Undo split</source>
        <translation>Deshacer división</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/split_tab.py"/>
        <source>Write the part of each image to the tables, and labels.json</source>
        <translation>Escribir la parte de cada imagen en las tablas, y labels.json</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/split_tab.py"/>
        <source>Written to the tables: {how}.</source>
        <translation>Escrito en las tablas: {how}.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/split_tab.py"/>
        <location filename="../../terrainav_plugin/form/headings.py"/>
        <source>automatic</source>
        <translation>automática</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/split_tab.py"/>
        <source>{count} blocks with sides of {side} m</source>
        <translation>{count} bloques de {side} m de lado</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/split_tab.py"/>
        <source>{count} images in no part.</source>
        <translation>{count} imágenes en ninguna parte.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/tab.py"/>
        <source>Choose the folder of a dataset.</source>
        <translation>Elegir la carpeta de un conjunto de datos.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/tab.py"/>
        <source>Reading was stopped; another tab and back reads the dataset again.</source>
        <translation>La lectura se ha detenido; cambie de pestaña y vuelva para leer de nuevo el conjunto de datos.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/tasks.py"/>
        <source>Cleaning {name}</source>
        <translation>Limpiando {name}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/tasks.py"/>
        <source>Exporting {name}</source>
        <translation>Exportando {name}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/tasks.py"/>
        <source>Images of {name}</source>
        <translation>Gráficos de {name}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/tasks.py"/>
        <source>Splitting {name}</source>
        <translation>Dividiendo {name}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/tasks.py"/>
        <source>Undoing the split of {name}</source>
        <translation>Deshaciendo la división de {name}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/tasks.py"/>
        <source>{moved} moved away.</source>
        <translation>{moved} apartadas.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/tasks.py"/>
        <source>{rejected} images are no longer marked, {returned} moved back.</source>
        <translation>{rejected} imágenes ya no están marcadas, {returned} devueltas a su sitio.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/tasks.py"/>
        <source>{rejected} of {images} images are marked as rejected.</source>
        <translation>{rejected} de {images} imágenes están marcadas como rechazadas.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/tasks.py"/>
        <source>{rejected} of {images} images of {count} map types are marked as rejected.</source>
        <translation>{rejected} de {images} imágenes de {count} tipos de mapa están marcadas como rechazadas.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/tasks.py"/>
        <source>{returned} moved back.</source>
        <translation>{returned} devueltas a su sitio.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/window.py"/>
        <source>Benchmark</source>
        <translation>Banco de pruebas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/window.py"/>
        <source>Clean</source>
        <translation>Limpiar</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/window.py"/>
        <source>Compare…</source>
        <translation>Comparar…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/window.py"/>
        <source>Dataset &amp;folder</source>
        <translation>Carpeta del con&amp;junto de datos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/window.py"/>
        <source>Dataset (TerrAInav)</source>
        <translation>Conjunto de datos (TerrAInav)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/window.py"/>
        <source>Export</source>
        <translation>Exportar</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/window.py"/>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>Flicker between two images on the map, such as two dates of one mission</source>
        <translation>Alternar entre dos imágenes en el mapa, como dos fechas de una misión</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/window.py"/>
        <location filename="../../terrainav_plugin/preview/layers.py"/>
        <source>Labels</source>
        <translation>Etiquetas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/window.py"/>
        <source>Of a capture, or of images with a meta_data.csv beside them</source>
        <translation>De una captura, o de imágenes con un meta_data.csv al lado</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/window.py"/>
        <source>Stop</source>
        <translation>Detener</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/window.py"/>
        <source>Stop; what a task has done so far can be finished, or undone</source>
        <translation>Detener; lo que una tarea ha hecho hasta ahora se puede terminar o deshacer</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset_window/window.py"/>
        <source>TerrAInav: folder of a dataset</source>
        <translation>TerrAInav: carpeta de un conjunto de datos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/foreign.py"/>
        <source>an unknown format</source>
        <translation>un formato desconocido</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/foreign.py"/>
        <source>image {path}: {reason}</source>
        <translation>imagen {path}: {reason}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/foreign.py"/>
        <source>{path}: QGIS would open it as {kind}; must be {right}</source>
        <translation>{path}: QGIS lo abriría como {kind}; debe ser {right}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/foreign.py"/>
        <source>{path}: QGIS would open {other} in its place; rename the folder</source>
        <translation>{path}: QGIS abriría {other} en su lugar; cambie el nombre de la carpeta</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/area.py"/>
        <source>1 hole</source>
        <translation>1 hueco</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/area.py"/>
        <source>Box, {size}</source>
        <translation>Recuadro, {size}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/area.py"/>
        <source>Polygon</source>
        <translation>Polígono</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/area.py"/>
        <source>Single capture</source>
        <translation>Captura única</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/area.py"/>
        <source>coordinates “{text}”: a comma may stand between numbers or before decimals; write points before decimals, or spaces between numbers</source>
        <translation>coordenadas «{text}»: una coma puede separar números o preceder a los decimales; escriba puntos ante los decimales, o espacios entre los números</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/area.py"/>
        <source>coordinates “{text}”: minutes and seconds must be below 60, and each latitude stand before its longitude</source>
        <translation>coordenadas «{text}»: los minutos y segundos deben ser menores que 60, y cada latitud debe preceder a su longitud</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/area.py"/>
        <source>each with its {last}</source>
        <translation>cada uno con su {last}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/area.py"/>
        <source>each with its {values} and {last}</source>
        <translation>cada uno con su {values}, así como {last}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/area.py"/>
        <source>gimbal pitch</source>
        <translation>cabeceo del gimbal</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/area.py"/>
        <source>give every point a yaw, or none</source>
        <translation>dé una guiñada a cada punto, o a ninguno</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/area.py"/>
        <source>line {number}:</source>
        <translation>línea {number}:</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/area.py"/>
        <source>roll</source>
        <translation>alabeo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/area.py"/>
        <source>the area's shape cannot be read: {error}</source>
        <translation>no se puede leer la forma del área: {error}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/area.py"/>
        <source>the area's shape is a box: must be a polygon or points</source>
        <translation>la forma del área es un recuadro: debe ser un polígono o puntos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/area.py"/>
        <source>tilt</source>
        <translation>inclinación</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/area.py"/>
        <source>time</source>
        <translation>hora</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/area.py"/>
        <source>yaw</source>
        <translation>guiñada</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/area.py"/>
        <location filename="../../terrainav_plugin/preview/layers.py"/>
        <source>yaw {yaw}°</source>
        <translation>guiñada {yaw}°</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/area.py"/>
        <source>yaw “{text}”: must be a number of degrees</source>
        <translation>guiñada «{text}»: debe ser un número de grados</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/area.py"/>
        <source>{n} corners</source>
        <translation>{n} vértices</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/area.py"/>
        <source>{n} holes</source>
        <translation>{n} huecos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/area.py"/>
        <source>{n} points</source>
        <translation>{n} puntos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/area.py"/>
        <source>{n} polygons</source>
        <translation>{n} polígonos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/area.py"/>
        <source>“{line}” has {count} numbers; several lines must be of lat lon agl [yaw]</source>
        <translation>«{line}» tiene {count} números; si hay varias líneas, deben ser de lat lon agl [guiñada]</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/headings.py"/>
        <source>first to last capture</source>
        <translation>de la primera captura a la última</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/headings.py"/>
        <source>from the take-off point</source>
        <translation>desde el punto de despegue</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/headings.py"/>
        <source>ground at {height}</source>
        <translation>terreno a {height}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/headings.py"/>
        <source>ideal camera</source>
        <translation>cámara ideal</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/headings.py"/>
        <source>lead-in {length}</source>
        <translation>tramo de entrada de {length}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/headings.py"/>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>level ground</source>
        <translation>terreno llano</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/headings.py"/>
        <source>no overlap</source>
        <translation>sin solape</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/headings.py"/>
        <source>none yet</source>
        <translation>aún ninguna</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/headings.py"/>
        <source>off</source>
        <translation>sin viento</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/headings.py"/>
        <source>overlap {share} %</source>
        <translation>solape {share} %</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/headings.py"/>
        <source>roll {angle}</source>
        <translation>alabeo {angle}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/headings.py"/>
        <source>sorties of {minutes} min</source>
        <translation>salidas de {minutes} min</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/headings.py"/>
        <source>straight down</source>
        <translation>en vertical</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/headings.py"/>
        <source>tilt {angle}</source>
        <translation>inclinación {angle}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/headings.py"/>
        <source>turnaround {length}</source>
        <translation>prolongación de {length}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/headings.py"/>
        <source>yaw {angle}</source>
        <translation>guiñada {angle}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/headings.py"/>
        <source>zoom {zoom}</source>
        <translation>zoom {zoom}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/headings.py"/>
        <source>{budget} px</source>
        <translation>{budget} px</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/headings.py"/>
        <source>{length} mm</source>
        <translation>{length} mm</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/headings.py"/>
        <source>{speed} m/s from {angle}</source>
        <translation>{speed} m/s desde {angle}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/headings.py"/>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>{width} × {height} px</source>
        <translation>{width} × {height} px</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/mission_form.py"/>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>GSD</source>
        <translation>GSD</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/mission_form.py"/>
        <source>GSD: must be above 0</source>
        <translation>GSD: debe ser mayor que 0</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/mission_form.py"/>
        <source>aspect ratio</source>
        <translation>relación de aspecto</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/mission_form.py"/>
        <source>aspect ratio “{text}”: must be from {least} to {most}</source>
        <translation>relación de aspecto «{text}»: debe estar entre {least} y {most}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/mission_form.py"/>
        <source>azimuth</source>
        <translation>acimut</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/mission_form.py"/>
        <source>coordinates are read when you leave the field</source>
        <translation>las coordenadas se toman al dejar el campo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/mission_form.py"/>
        <source>eastern edge</source>
        <translation>borde oriental</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/mission_form.py"/>
        <source>field of view</source>
        <translation>campo de visión</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/mission_form.py"/>
        <source>focal length</source>
        <translation>distancia focal</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/mission_form.py"/>
        <source>height above ground {height} {unit}: must be above 0</source>
        <translation>altura sobre el terreno {height} {unit}: debe ser mayor que 0</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/mission_form.py"/>
        <source>image height</source>
        <translation>altura de la imagen</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/mission_form.py"/>
        <source>image width</source>
        <translation>anchura de la imagen</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/mission_form.py"/>
        <source>no map type: tick one or more</source>
        <translation>ningún tipo de mapa: marque uno o más</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/mission_form.py"/>
        <source>northern edge</source>
        <translation>borde norte</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/mission_form.py"/>
        <source>sensor height</source>
        <translation>altura del sensor</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/mission_form.py"/>
        <source>sensor width</source>
        <translation>anchura del sensor</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/mission_form.py"/>
        <source>several imageries: tick one map type here, and add the others as imagery</source>
        <translation>varias fuentes: marque aquí un solo tipo de mapa y añada los demás como fuentes</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/mission_form.py"/>
        <source>southern edge</source>
        <translation>borde sur</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/mission_form.py"/>
        <source>take-off “{text}”: must be a latitude and a longitude, such as {example}</source>
        <translation>despegue «{text}»: debe ser una latitud y una longitud, como {example}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/mission_form.py"/>
        <source>this source cannot be one of several: save it under another name first</source>
        <translation>esta fuente no puede ser una de varias: guárdela antes con otro nombre</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/mission_form.py"/>
        <source>western edge</source>
        <translation>borde occidental</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/mission_form.py"/>
        <source>{what} “{text}”: is too large</source>
        <translation>{what} «{text}»: es demasiado grande</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/mission_form.py"/>
        <source>{what} “{text}”: is too small</source>
        <translation>{what} «{text}»: es demasiado pequeño</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/mission_form.py"/>
        <source>{what} “{text}”: minutes and seconds must be below 60</source>
        <translation>{what} «{text}»: los minutos y segundos deben ser menores que 60</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/mission_form.py"/>
        <source>{what} “{text}”: must be 0 or more</source>
        <translation>{what} «{text}»: debe ser 0 o más</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/mission_form.py"/>
        <source>{what} “{text}”: must be a number</source>
        <translation>{what} «{text}»: debe ser un número</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/mission_form.py"/>
        <source>{what} “{text}”: must be a whole number</source>
        <translation>{what} «{text}»: debe ser un número entero</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/presets.py"/>
        <source>camera {name}</source>
        <translation>cámara {name}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/form/presets.py"/>
        <source>size of the images</source>
        <translation>tamaño de las imágenes</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/help.py"/>
        <location filename="../../terrainav_plugin/panel/dock.py"/>
        <source>Open the guide</source>
        <translation>Abrir la guía</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/help.py"/>
        <source>TerrAInav: guide</source>
        <translation>TerrAInav: guía</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/i18n.py"/>
        <location filename="../../terrainav_plugin/panel/imagery.py"/>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>Date</source>
        <translation>Fecha</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/i18n.py"/>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Resize images</source>
        <translation>Redimensionar</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/i18n.py"/>
        <source>a layer of the project</source>
        <translation>una capa del proyecto</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/i18n.py"/>
        <source>a layer that is not in the project</source>
        <translation>una capa que no está en el proyecto</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/i18n.py"/>
        <source>“Maximum number of images” of the algorithm “Plan a mission”, or max_images in the mission's file</source>
        <translation>«Número máximo de imágenes» del algoritmo «Planificar una misión», o max_images en el archivo de la misión</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/i18n.py"/>
        <source>“{entry}”</source>
        <translation>«{entry}»</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/dock.py"/>
        <source> per s</source>
        <translation> por s</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/dock.py"/>
        <source>&amp;Follow flight</source>
        <translation>Seguir el &amp;vuelo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/dock.py"/>
        <source>&amp;Tilt</source>
        <translation>&amp;Inclinación</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/dock.py"/>
        <source>&amp;Yaw</source>
        <translation>&amp;Guiñada</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/dock.py"/>
        <source>Angle between the view and the vertical: 0 looks straight down</source>
        <translation>Ángulo entre la vista y la vertical: 0 mira hacia abajo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/dock.py"/>
        <source>Direction of the image's top edge, clockwise from north</source>
        <translation>Dirección del borde superior de la imagen, en sentido horario desde el norte</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/dock.py"/>
        <source>Drag the camera on the map, and its handle to turn it; with the keyboard on the map, use arrow keys</source>
        <translation>Arrastre la cámara en el mapa, y su tirador para girarla; con el teclado en el mapa, use las flechas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/dock.py"/>
        <source>Folder of the dataset that a recording becomes</source>
        <translation>Carpeta del conjunto de datos en que se convierte una grabación</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/dock.py"/>
        <source>Folder of the recording</source>
        <translation>Carpeta de la grabación</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/dock.py"/>
        <source>He&amp;ight</source>
        <translation>A&amp;ltura</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/dock.py"/>
        <source>Height of the camera above ground</source>
        <translation>Altura de la cámara sobre el terreno</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/dock.py"/>
        <source>I&amp;nto</source>
        <translation>E&amp;n</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/dock.py"/>
        <source>Images of a recording while you move the camera</source>
        <translation>Imágenes de una grabación mientras mueve la cámara</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/dock.py"/>
        <source>Move on m&amp;ap</source>
        <translation>Mover en el m&amp;apa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/dock.py"/>
        <source>Note the poses of the camera until you press again, then capture an image from each</source>
        <translation>Anotar las poses de la cámara hasta que pulse de nuevo, y capturar después una imagen desde cada una</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/dock.py"/>
        <source>Picture of the camera</source>
        <translation>Imagen de la cámara</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/dock.py"/>
        <source>Rec&amp;ord</source>
        <translation>Gra&amp;bar</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/dock.py"/>
        <source>Roll</source>
        <translation>Alabeo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/dock.py"/>
        <source>Show what the camera sees in the planned flight, at the time of QGIS's temporal controller</source>
        <translation>Mostrar lo que ve la cámara en el vuelo planificado, a la hora del controlador temporal de QGIS</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/dock.py"/>
        <source>Stop rec&amp;ording ({poses})</source>
        <translation>Dejar de gra&amp;bar ({poses})</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/dock.py"/>
        <source>TerrAInav: live view</source>
        <translation>TerrAInav: vista en directo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/dock.py"/>
        <source>Turn of the camera about its view</source>
        <translation>Giro de la cámara en torno a su vista</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/dock.py"/>
        <source>error ≤ {px} px</source>
        <translation>error ≤ {px} px</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/dock.py"/>
        <source>relief still level, error unknown</source>
        <translation>relieve aún llano, error desconocido</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/dock.py"/>
        <location filename="../../terrainav_plugin/preview/layers.py"/>
        <source>yaw {yaw}°, tilt {tilt}°, roll {roll}°</source>
        <translation>guiñada {yaw}°, inclinación {tilt}°, alabeo {roll}°</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/dock.py"/>
        <source>{height} {unit} above ground</source>
        <translation>{height} {unit} sobre el terreno</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/dock.py"/>
        <source>{ms} ms</source>
        <translation>{ms} ms</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/dock.py"/>
        <source>{share} % at lower resolution until its tiles are here</source>
        <translation>{share} % a menor resolución hasta que lleguen sus teselas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/view.py"/>
        <source>Name a folder for the recording.</source>
        <translation>Indique una carpeta para la grabación.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/view.py"/>
        <source>Opening the imagery…</source>
        <translation>Abriendo las imágenes…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/view.py"/>
        <source>The flight is from {begin} to {end} UTC, and the temporal controller at {now}.</source>
        <translation>El vuelo va de {begin} a {end} UTC, y el controlador temporal está en {now}.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/view.py"/>
        <source>The flight is from {begin} to {end} UTC: play it in QGIS's temporal controller.</source>
        <translation>El vuelo va de {begin} a {end} UTC: reprodúzcalo en el controlador temporal de QGIS.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/view.py"/>
        <source>There is no flight to follow: enter a mission in the panel first.</source>
        <translation>No hay vuelo que seguir: introduzca antes una misión en el panel.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/view.py"/>
        <source>There is no picture to record.</source>
        <translation>No hay imagen que grabar.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/view.py"/>
        <source>{folder} holds a mission already: name another folder.</source>
        <translation>{folder} ya contiene una misión: indique otra carpeta.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/map/canvas.py"/>
        <source>(custom)</source>
        <translation>(personalizado)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/map/canvas.py"/>
        <source>CRS {crs}: must be one of the Earth, such as EPSG:4326</source>
        <translation>SRC {crs}: debe ser uno de la Tierra, como EPSG:4326</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/map/canvas.py"/>
        <source>this place cannot be shown in the project's CRS {crs}; choose another CRS</source>
        <translation>este lugar no se puede mostrar en el SRC del proyecto, {crs}; elija otro SRC</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/map/canvas.py"/>
        <source>this place is outside the domain of the project's CRS {crs}</source>
        <translation>este lugar está fuera del dominio del SRC del proyecto, {crs}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/map/mission_group.py"/>
        <source>TerrAInav: datasets of one mission</source>
        <translation>TerrAInav: conjuntos de datos de una misión</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/map/mission_group.py"/>
        <source>TerrAInav: {name}</source>
        <translation>TerrAInav: {name}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/map/mission_group.py"/>
        <location filename="../../terrainav_plugin/missions/plan_export.py"/>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>mission</source>
        <translation>misión</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/messages.py"/>
        <source>Details</source>
        <translation>Detalles</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/address_dialog.py"/>
        <source>&amp;Address</source>
        <translation>&amp;Dirección</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/address_dialog.py"/>
        <location filename="../../terrainav_plugin/panel/imagery.py"/>
        <source>Authentication</source>
        <translation>Autenticación</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/address_dialog.py"/>
        <source>For requests to this web server; object stores use the settings of AWS's tools</source>
        <translation>Se aplica a las peticiones a este servidor web; los almacenes de objetos usan lo que tengan configurado las herramientas de AWS</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/address_dialog.py"/>
        <source>TerrAInav: open dataset at an address</source>
        <translation>TerrAInav: abrir un conjunto de datos en una dirección</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/address_dialog.py"/>
        <source>The dataset's folder, or its collection.json, items.parquet or meta_data.csv</source>
        <translation>La carpeta del conjunto de datos, o su collection.json, items.parquet o meta_data.csv</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/address_dialog.py"/>
        <source>datasets-at-an-address</source>
        <translation>conjuntos-de-datos-en-una-dirección</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/joined_export.py"/>
        <source>&amp;Add mission files…</source>
        <translation>&amp;Añadir archivos de misión…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/joined_export.py"/>
        <source>Add missions saved as files</source>
        <translation>Añadir misiones guardadas como archivos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/joined_export.py"/>
        <source>Export…</source>
        <translation>Exportar…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/joined_export.py"/>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>Mission files (*.json);;All files (*)</source>
        <translation>Archivos de misión (*.json);;Todos los archivos (*)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/joined_export.py"/>
        <source>Missions in the order of the flight: drag them to change it</source>
        <translation>Misiones en el orden del vuelo: arrástrelas para cambiarlo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/joined_export.py"/>
        <source>TerrAInav: add missions</source>
        <translation>TerrAInav: añadir misiones</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/joined_export.py"/>
        <source>TerrAInav: export as one flight</source>
        <translation>TerrAInav: exportar como un solo vuelo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>&amp;Dataset…</source>
        <translation>Con&amp;junto de datos…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>&amp;Export plan…</source>
        <translation>&amp;Exportar plan…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>&amp;New mission</source>
        <translation>&amp;Nueva misión</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>&amp;Open mission file…</source>
        <translation>&amp;Abrir archivo de misión…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>&amp;Save mission as file…</source>
        <translation>&amp;Guardar misión como archivo…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>Allow</source>
        <translation>Permitir</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>Back to {name}</source>
        <translation>Volver a {name}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>Capture only the &amp;failed images</source>
        <translation>Capturar solo las imágenes &amp;fallidas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>Capture the images of the panel's mission that failed earlier</source>
        <translation>Capturar las imágenes de la misión del panel que fallaron antes</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>Clean, split, export and look at the dataset of the panel's mission</source>
        <translation>Limpiar, dividir, exportar y ver el conjunto de datos de la misión del panel</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>Co&amp;mpare images…</source>
        <translation>Co&amp;mparar imágenes…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>Export as one fligh&amp;t…</source>
        <translation>Exportar como un solo vue&amp;lo…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>Export to a &amp;vehicle…</source>
        <translation>Exportar a un &amp;vehículo…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>For DJI Pilot 2, QGroundControl, Litchi or Google Earth; as GPX, GeoPackage, GeoJSON or a table</source>
        <translation>Para DJI Pilot 2, QGroundControl, Litchi o Google Earth; como GPX, GeoPackage, GeoJSON o tabla</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>In this project</source>
        <translation>En este proyecto</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>Mission files (*.json)</source>
        <translation>Archivos de misión (*.json)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>Mission saved as {name}.</source>
        <translation>Misión guardada como {name}.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>Nothing to save yet.</source>
        <translation>Aún no hay nada que guardar.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>On a web server or in an object store, such as https://host/run or s3://bucket/run</source>
        <translation>En un servidor web o en un almacén de objetos, como https://host/run o s3://bucket/run</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>Open &amp;dataset folder…</source>
        <translation>Abrir carpeta de conjunto de &amp;datos…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>Open &amp;recent</source>
        <translation>Abrir &amp;reciente</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>Open dataset at an &amp;address…</source>
        <translation>Abrir conjunto de datos en una d&amp;irección…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>Opening {name}</source>
        <translation>Abriendo {name}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>Several missions in one flight plan, with safe transits between them</source>
        <translation>Varias misiones en un solo plan de vuelo, con tránsitos seguros entre ellas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>TerrAInav: open dataset</source>
        <translation>TerrAInav: abrir conjunto de datos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>TerrAInav: open mission</source>
        <translation>TerrAInav: abrir misión</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>TerrAInav: save mission</source>
        <translation>TerrAInav: guardar misión</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>The project's mission cannot be read: {error}</source>
        <translation>No se puede leer la misión del proyecto: {error}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>Upload the flight to PX4 or ArduPilot over MAVLink, with the Python package pymavlink</source>
        <translation>Envía el vuelo a PX4 o ArduPilot por MAVLink, con el paquete de Python pymavlink</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>What you opened takes imagery, heights or datasets from {places}, which you have not used in this QGIS. Nothing is requested there until you allow it.</source>
        <translation>Lo que ha abierto toma imágenes, alturas o conjuntos de datos de {places}, que no se ha usado en este QGIS. No se le consulta nada hasta que lo permita.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>flight</source>
        <translation>vuelo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>folder {folder}: has no {name}, so it is not a dataset of a capture; choose its folder</source>
        <translation>carpeta {folder}: no tiene {name}, así que no es el conjunto de datos de una captura; elija su carpeta</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>it needs {place}, which you have not used in this QGIS</source>
        <translation>se consultaría {place}, que no se ha usado en este QGIS</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>its folder is not a path</source>
        <translation>su carpeta no es una ruta</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>{name} was not captured.</source>
        <translation>{name} no se ha capturado.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>{name} was not opened: {reason}</source>
        <translation>No se ha abierto {name}: {reason}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/missions.py"/>
        <source>{name}: opened without mosaic: {reason}</source>
        <translation>{name}: abierto sin mosaico: {reason}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/plan_export.py"/>
        <source>DJI Pilot 2, FlightHub 2, DJI Fly</source>
        <translation>DJI Pilot 2, FlightHub 2, DJI Fly</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/plan_export.py"/>
        <source>GPX route</source>
        <translation>Ruta GPX</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/plan_export.py"/>
        <source>GeoJSON footprints</source>
        <translation>Huellas GeoJSON</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/plan_export.py"/>
        <source>GeoPackage</source>
        <translation>GeoPackage</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/plan_export.py"/>
        <source>Google Earth</source>
        <translation>Google Earth</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/plan_export.py"/>
        <source>Litchi</source>
        <translation>Litchi</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/plan_export.py"/>
        <location filename="../../terrainav_plugin/missions/vehicle_export.py"/>
        <source>Nothing to export yet.</source>
        <translation>Aún no hay nada que exportar.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/plan_export.py"/>
        <source>Plan exported as {names}.</source>
        <translation>Plan exportado como {names}.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/plan_export.py"/>
        <source>QGroundControl survey</source>
        <translation>Levantamiento (survey) de QGroundControl</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/plan_export.py"/>
        <source>QGroundControl waypoints</source>
        <translation>Puntos de ruta de QGroundControl</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/plan_export.py"/>
        <source>Table</source>
        <translation>Tabla</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/plan_export.py"/>
        <source>TerrAInav: export plan</source>
        <translation>TerrAInav: exportar plan</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/plan_export.py"/>
        <source>Writing {name}</source>
        <translation>Escribiendo {name}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/plan_export.py"/>
        <source>{count} files, {first} to {last}, are already there. Replace them?</source>
        <translation>{count} archivos, de {first} a {last}, ya existen. ¿Reemplazarlos?</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/plan_export.py"/>
        <source>{name} is already there. Replace it?</source>
        <translation>{name} ya existe. ¿Reemplazarlo?</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/plan_export.py"/>
        <source>{name} is still being written; try again when it is there.</source>
        <translation>{name} todavía se está escribiendo; inténtelo de nuevo cuando esté.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/vehicle_export.py"/>
        <source>A flight is being sent to {address}.</source>
        <translation>Se está enviando un vuelo a {address}.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/vehicle_export.py"/>
        <source>Address: tcp:HOST:PORT, udp:HOST:PORT (waits there for the vehicle) or udpout:HOST:PORT</source>
        <translation>Dirección: tcp:EQUIPO:PUERTO, udp:EQUIPO:PUERTO (espera allí al vehículo) o udpout:EQUIPO:PUERTO</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/vehicle_export.py"/>
        <source>Sending the flight to {address}</source>
        <translation>Enviando el vuelo a {address}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/vehicle_export.py"/>
        <source>Sortie, of {count}: a vehicle takes one</source>
        <translation>Salida, de {count}: un vehículo acepta una</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/vehicle_export.py"/>
        <source>TerrAInav: export to a vehicle</source>
        <translation>TerrAInav: exportar a un vehículo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/missions/vehicle_export.py"/>
        <source>{address}: the vehicle has accepted {count} mission items.</source>
        <translation>{address}: el vehículo ha aceptado {count} elementos de la misión.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/alignment.py"/>
        <source>Aligning the rows</source>
        <translation>Alineando las pasadas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/alignment.py"/>
        <source>The entries changed while the rows were being aligned: press the button again.</source>
        <translation>Las entradas han cambiado mientras se alineaban las pasadas: pulse el botón de nuevo.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/alignment.py"/>
        <source>The rows stay as they are.</source>
        <translation>Las pasadas quedan como están.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/camera.py"/>
        <source>Actual focal length of the lens in millimetres, not its full-frame equivalent</source>
        <translation>Distancia focal real del objetivo en milímetros, no la equivalente en formato completo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/camera.py"/>
        <source>Aspect ra&amp;tio</source>
        <translation>Relación de as&amp;pecto</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/camera.py"/>
        <source>C&amp;amera</source>
        <translation>Cámar&amp;a</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/camera.py"/>
        <location filename="../../terrainav_plugin/processing/mission_parameters.py"/>
        <source>Camera</source>
        <translation>Cámara</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/camera.py"/>
        <location filename="../../terrainav_plugin/panel/presets.py"/>
        <source>Custom</source>
        <translation>Personalizado</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/camera.py"/>
        <source>Diagonal</source>
        <translation>Diagonal</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/camera.py"/>
        <source>F&amp;ield of view</source>
        <translation>Campo de vis&amp;ión</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/camera.py"/>
        <source>Field of view across the image's diagonal, in degrees</source>
        <translation>Campo de visión en la diagonal de la imagen, en grados</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/camera.py"/>
        <source>Field of view across the image's width or height, as selected, in degrees</source>
        <translation>Campo de visión a lo ancho o a lo alto de la imagen, según lo elegido, en grados</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/camera.py"/>
        <source>Fills in field of view (degrees), aspect ratio and the image's longer side (px)</source>
        <translation>Rellena campo de visión (grados), relación de aspecto y lado mayor de la imagen (px)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/camera.py"/>
        <source>Focal length</source>
        <translation>Distancia focal</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/camera.py"/>
        <source>Height of the sensor in millimetres</source>
        <translation>Altura del sensor en milímetros</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/camera.py"/>
        <source>Horizontal</source>
        <translation>Horizontal</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/camera.py"/>
        <source>How to enter the field of view: in degrees across the image's diagonal, width or height, or as focal length and sensor in mm. A change converts the values.</source>
        <translation>Cómo introducir el campo de visión: en grados en la diagonal, la anchura o la altura de la imagen, o como distancia focal y sensor en mm. Un cambio convierte los valores.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/camera.py"/>
        <source>Name of the camera:</source>
        <translation>Nombre de la cámara:</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/camera.py"/>
        <source>Remove this camera</source>
        <translation>Eliminar esta cámara</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/camera.py"/>
        <source>Save camera</source>
        <translation>Guardar cámara</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/camera.py"/>
        <source>Save these values as your own camera, or remove one</source>
        <translation>Guardar estos valores como cámara propia, o eliminar una</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/camera.py"/>
        <source>Save these values as…</source>
        <translation>Guardar estos valores como…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/camera.py"/>
        <source>Sensor</source>
        <translation>Sensor</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/camera.py"/>
        <source>Sensor {width} × {height} mm, focal length {focal} mm</source>
        <translation>Sensor de {width} × {height} mm, distancia focal de {focal} mm</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/camera.py"/>
        <source>Source: {source}</source>
        <translation>Fuente: {source}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/camera.py"/>
        <source>The real camera's images: {width} × {height} px</source>
        <translation>Imágenes de la cámara real: {width} × {height} px</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/camera.py"/>
        <source>These values are not a valid camera: fix the highlighted fields, then save.</source>
        <translation>Estos valores no forman una cámara válida: corrija los campos resaltados y guarde después.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/camera.py"/>
        <source>Vertical</source>
        <translation>Vertical</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/camera.py"/>
        <source>Width of the sensor in millimetres</source>
        <translation>Anchura del sensor en milímetros</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/camera.py"/>
        <source>Width to height of the image, such as 4:3, 4000x3000 or 1.333</source>
        <translation>Anchura entre altura de la imagen, como 4:3, 4000x3000 o 1,333</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/camera.py"/>
        <source>{name}: {degrees}° across the diagonal</source>
        <translation>{name}: {degrees}° en diagonal</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/choices.py"/>
        <source> (native up to zoom {native})</source>
        <translation> (nativo hasta el zoom {native})</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/choices.py"/>
        <source>A service with several layers: choose it, then a layer. The layer is saved with your own sources.</source>
        <translation>Un servicio con varias capas: elíjalo y después elija una capa, que se guarda con sus propias fuentes.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/choices.py"/>
        <source>Computed on this computer for any place, without limits.</source>
        <translation>Calculado en este equipo para cualquier lugar, sin límites.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/choices.py"/>
        <source>Its terms are unknown: check them yourself.</source>
        <translation>Se desconocen sus condiciones: compruébelas.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/choices.py"/>
        <source>Licence not stated</source>
        <translation>Licencia no indicada</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/choices.py"/>
        <source>Missing connection</source>
        <translation>Conexión que no existe</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/choices.py"/>
        <source>Missing layer</source>
        <translation>Capa que no existe</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/choices.py"/>
        <source>QGIS draws it as on the map, from the layer's data source.</source>
        <translation>QGIS la dibuja como en el mapa, a partir de la fuente de datos de la capa.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/choices.py"/>
        <source>at most {count} requests</source>
        <translation>{count} peticiones como máximo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/choices.py"/>
        <source>over {count} requests require accepting the terms</source>
        <translation>más de {count} peticiones exigen aceptar las condiciones</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/choices.py"/>
        <source>terms</source>
        <translation>condiciones</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/choices.py"/>
        <source>tiles are cached</source>
        <translation>las teselas se guardan en la caché</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/choices.py"/>
        <source>tiles are not cached</source>
        <translation>las teselas no se guardan en la caché</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/choices.py"/>
        <source>unlimited requests</source>
        <translation>peticiones sin límite</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/choices.py"/>
        <source>zoom {least} to {most}</source>
        <translation>zoom {least} a {most}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/choices.py"/>
        <source>{count} connections</source>
        <translation>{count} conexiones</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/choices.py"/>
        <source>{name}…</source>
        <translation>{name}…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/choices.py"/>
        <source>{rate} requests a second</source>
        <translation>{rate} peticiones por segundo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/dock.py"/>
        <source>Capture</source>
        <translation>Capturar</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/dock.py"/>
        <source>Capture all images; resumes where an earlier run stopped</source>
        <translation>Capturar todas las imágenes; continúa donde se detuvo una ejecución anterior</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/dock.py"/>
        <source>Click a point on the map and capture one image there</source>
        <translation>Haga clic en un punto del mapa y capture allí una imagen</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/dock.py"/>
        <source>Export plan…</source>
        <translation>Exportar plan…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/dock.py"/>
        <source>Help</source>
        <translation>Ayuda</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/dock.py"/>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <location filename="../../terrainav_plugin/processing/algorithm.py"/>
        <source>Missions</source>
        <translation>Misiones</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/dock.py"/>
        <location filename="../../terrainav_plugin/panel/planning.py"/>
        <location filename="../../terrainav_plugin/profile/profiles.py"/>
        <source>No area yet.</source>
        <translation>Aún no hay área.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/dock.py"/>
        <source>Nothing to export yet: {reason}</source>
        <translation>Aún no hay nada que exportar: {reason}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/dock.py"/>
        <source>Open, save and start missions: of this project, from files or from datasets</source>
        <translation>Abrir, guardar y empezar misiones: de este proyecto, de archivos o de conjuntos de datos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/dock.py"/>
        <source>Opening {name}…</source>
        <translation>Abriendo {name}…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/dock.py"/>
        <source>Preview</source>
        <translation>Vista previa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/dock.py"/>
        <source>Show every planned image on the map</source>
        <translation>Mostrar en el mapa todas las imágenes planificadas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/dock.py"/>
        <source>TerrAInav mission</source>
        <translation>Misión de TerrAInav</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/dock.py"/>
        <source>Write the plan as a file for drones, ground stations and other programs</source>
        <translation>Guardar el plan en un archivo para drones, estaciones de tierra y otros programas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/elevation.py"/>
        <source>Choose a source of heights</source>
        <translation>Elegir una fuente de alturas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/elevation.py"/>
        <location filename="../../terrainav_plugin/panel/layers.py"/>
        <source>File…</source>
        <translation>Archivo…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/elevation.py"/>
        <source>Fill its holes from</source>
        <translation>Rellenar sus huecos con</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/elevation.py"/>
        <source>Heights of the ground</source>
        <translation>Alturas del terreno</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/elevation.py"/>
        <source>Level ground</source>
        <translation>Terreno llano</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/elevation.py"/>
        <source>Raster files (*)</source>
        <translation>Archivos ráster (*)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/elevation.py"/>
        <source>Separate several with ; each fills the holes of those before it.</source>
        <translation>Varias separadas por ;: cada una rellena los huecos de las anteriores.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/elevation.py"/>
        <source>Synthetic landscape (offline)</source>
        <translation>Paisaje sintético (sin conexión)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/elevation.py"/>
        <source>Terrain Tiles (Terrarium, public)</source>
        <translation>Terrain Tiles (Terrarium, públicas)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/elevation.py"/>
        <source>Terrain of the project ({name})</source>
        <translation>Terreno del proyecto ({name})</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/entries.py"/>
        <source>Azimuth</source>
        <translation>Acimut</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/entries.py"/>
        <source>Flight direction</source>
        <translation>Dirección de vuelo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>, which is exceeded</source>
        <translation>, que se supera</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>1 image</source>
        <translation>1 imagen</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>100 % of {area}</source>
        <translation>100 % de {area}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>100 % of {area}, except where imagery is missing</source>
        <translation>100 % de {area}, salvo donde faltan imágenes</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>; not {name}: {reason}</source>
        <translation>; no {name}: {reason}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>About {duration}</source>
        <translation>Unos {duration}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>About {duration}, then {mosaic} for the mosaic</source>
        <translation>Unos {duration}, y después {mosaic} para el mosaico</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>About {size} in {count} tiles</source>
        <translation>Unos {size} en {count} teselas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>All estimates: coverage, overlap, flight, download, methods with their error bounds, and more</source>
        <translation>Todas las estimaciones: cobertura, solape, vuelo, descarga, métodos con sus cotas de error y más</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>At least {shares}</source>
        <translation>Al menos {shares}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>Cancel</source>
        <translation>Cancelar</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>Condition number</source>
        <translation>Número de condición</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>Cost</source>
        <translation>Coste</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>Coverage</source>
        <translation>Cobertura</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>Download</source>
        <translation>Descarga</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>Error</source>
        <translation>Error</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>Estimates</source>
        <translation>Estimación</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>Fix the highlighted fields.</source>
        <translation>Corrija los campos resaltados.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <location filename="../../terrainav_plugin/panel/form.py"/>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <location filename="../../terrainav_plugin/profile/dock.py"/>
        <source>Flight</source>
        <translation>Vuelo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>GSD {finest} at the highest point, {coarsest} at the lowest</source>
        <translation>GSD de {finest} en lo más alto y de {coarsest} en lo más bajo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>GSD {size}</source>
        <translation>GSD {size}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>Ground from {lowest} to {highest}, images at least {clearance} clear</source>
        <translation>Terreno de {lowest} a {highest}, imágenes a {clearance} de él como mínimo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>Image</source>
        <translation>Imagen</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>Images left out: {count}</source>
        <translation>Imágenes omitidas: {count}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>Left out</source>
        <translation>Se omite</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>Limit</source>
        <translation>Límite</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>Measuring…</source>
        <translation>Midiendo…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>Methods</source>
        <translation>Métodos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>No download ({count} local tiles)</source>
        <translation>Sin descarga ({count} teselas locales)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>No {what}</source>
        <translation>Sin {what}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>Nothing</source>
        <translation>Nada</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>On disk</source>
        <translation>En disco</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Overlap</source>
        <translation>Solape</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>Read them</source>
        <translation>Leerlos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Relief</source>
        <translation>Relieve</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>Requested {requested}, delivered {delivered}</source>
        <translation>Pedido {requested}, entregado {delivered}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>Terrain</source>
        <translation>Relieve</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>The files of labels and buildings have not been read.</source>
        <translation>No se han leído los archivos de etiquetas y edificios.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>The source covers {share} of the area</source>
        <translation>La fuente cubre el {share} del área</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>Tiles</source>
        <translation>Teselas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>Time</source>
        <translation>Tiempo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <location filename="../../terrainav_plugin/panel/planning.py"/>
        <source>Working out the plan…</source>
        <translation>Calculando el plan…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>another source</source>
        <translation>otra fuente</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>fly higher</source>
        <translation>volar más alto</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>front {share}</source>
        <translation>longitudinal {share}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>side {share}</source>
        <translation>transversal {share}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>the source's GSD is {source}: images show no finer detail</source>
        <translation>la GSD de la fuente es de {source}: las imágenes no muestran más detalle</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>unlimited at the horizon</source>
        <translation>sin límite en el horizonte</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>upsample</source>
        <translation>sobremuestrear</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>{area} outside no-fly areas</source>
        <translation>{area} fuera de las zonas de exclusión</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>{count} of the {most} requests that the provider allows</source>
        <translation>{count} de las {most} peticiones que permite el proveedor</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>{count} requests, but the provider allows {most}: choose a smaller area, a coarser GSD or another source</source>
        <translation>{count} peticiones, pero el proveedor permite {most}: elija un área menor, una GSD mayor u otra fuente</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>{count} requests. Over {most} requests require accepting the terms: Capture asks you to.</source>
        <translation>{count} peticiones. Más de {most} peticiones exigen aceptar las condiciones: Capturar se lo pedirá.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>{count}, each fetched once</source>
        <translation>{count}, cada una pedida una vez</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>{distance}, {duration}</source>
        <translation>{distance}, {duration}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>{distance}, {duration} with turns</source>
        <translation>{distance}, {duration} con los giros</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>{duration} to capture</source>
        <translation>{duration} de captura</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>{images} in one row</source>
        <translation>{images} en una pasada</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>{images} in {rows} rows</source>
        <translation>{images} en {rows} pasadas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>{images} of {count} imageries</source>
        <translation>{images} de {count} fuentes</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>{lost}; {held} of the area</source>
        <translation>{lost}; {held} del área</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>{name}, ≤ {px} px, {metres} on the ground</source>
        <translation>{name}, ≤ {px} px, {metres} sobre el terreno</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>{n} images</source>
        <translation>{n} imágenes</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>{share} % covered</source>
        <translation>{share} % cubierto</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>{share} % of {area}; {uncovered} not covered</source>
        <translation>{share} % de {area}; {uncovered} sin cubrir</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>{size} of {width} × {height}: the source has {gsd}</source>
        <translation>{size} de {width} × {height}: la fuente tiene {gsd}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>{stage}: {name}, ≤ {px} px</source>
        <translation>{stage}: {name}, ≤ {px} px</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>{text}, for each of {count} imageries</source>
        <translation>{text}, de cada una de las {count} fuentes</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>{text}, for each of {count} map types</source>
        <translation>{text}, para cada uno de {count} tipos de mapa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>{text}; relief hides about {share} %</source>
        <translation>{text}; el relieve oculta alrededor del {share} %</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>{width} × {height} px at zoom {zoom}</source>
        <translation>{width} × {height} px con zoom {zoom}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>{width} × {height} px, resized from {size}</source>
        <translation>{width} × {height} px, redimensionada desde {size}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>{width} × {height} px: {pixels}</source>
        <translation>{width} × {height} px: {pixels}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/figures.py"/>
        <source>≤ {bound} px of a budget of {budget} px</source>
        <translation>≤ {bound} px de {budget} px admisibles</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/form.py"/>
        <source>Advanced</source>
        <translation>Avanzado</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/form.py"/>
        <source>Attitude, relief, labels, realism, flight path, pixels, wind and accuracy</source>
        <translation>Actitud, relieve, etiquetas, realismo, ruta de vuelo, píxeles, viento y exactitud</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/form.py"/>
        <source>Camera and flight</source>
        <translation>Cámara y vuelo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/form.py"/>
        <source>Imagery and output</source>
        <translation>Imágenes y salida</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/form.py"/>
        <source>What the images are to show</source>
        <translation>Lo que deben mostrar las imágenes</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/headings.py"/>
        <source>{title}: {values}</source>
        <translation>{title}: {values}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery.py"/>
        <source>API key</source>
        <translation>Clave API</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery.py"/>
        <source>API key, kept in QGIS's authentication database as the password of a configuration</source>
        <translation>Clave API, guardada en la base de datos de autenticación de QGIS como contraseña de una configuración</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery.py"/>
        <source>Add a source by URL, open a file, and more</source>
        <translation>Añadir una fuente por URL, abrir un archivo y más</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery.py"/>
        <source>Add source by URL…</source>
        <translation>Añadir fuente por URL…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery.py"/>
        <source>Add this source to the map as background and zoom to the area</source>
        <translation>Añadir esta fuente al mapa como fondo y hacer zoom al área</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery.py"/>
        <source>Address of the tiles with {z}, {x} and {y} or {-y}; also {s}, {q}, {r}, {map_type}, {date}</source>
        <translation>Dirección de las teselas con {z}, {x} e {y} o {-y}; también {s}, {q}, {r}, {map_type}, {date}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery.py"/>
        <source>Cache…</source>
        <translation>Caché…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery.py"/>
        <source>Catalogue: one country</source>
        <translation>Catálogo: un país</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery.py"/>
        <source>Catalogue: worldwide</source>
        <translation>Catálogo: todo el mundo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery.py"/>
        <source>Date of the imagery, in the format that the server accepts</source>
        <translation>Fecha de las imágenes, como la acepta el servidor</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery.py"/>
        <source>Date of the imagery: {dates}</source>
        <translation>Fecha de las imágenes: {dates}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery.py"/>
        <source>Files</source>
        <translation>Archivos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery.py"/>
        <source>How QGIS authenticates requests to this source; a configuration of its authentication database</source>
        <translation>Cómo autentica QGIS las peticiones a esta fuente; una configuración de su base de datos de autenticación</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery.py"/>
        <source>Open raster or MBTiles file…</source>
        <translation>Abrir archivo ráster o MBTiles…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery.py"/>
        <source>Other</source>
        <translation>Otras</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery.py"/>
        <source>QGIS connections: WMS and WMTS</source>
        <translation>Conexiones de QGIS: WMS y WMTS</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery.py"/>
        <source>QGIS connections: XYZ tiles</source>
        <translation>Conexiones de QGIS: teselas XYZ</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery.py"/>
        <source>Raster or MBTiles file</source>
        <translation>Archivo ráster o MBTiles</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery.py"/>
        <source>Rasters and tiles ({endings});;All files (*)</source>
        <translation>Rásteres y teselas ({endings});;Todos los archivos (*)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery.py"/>
        <source>Remove this source</source>
        <translation>Eliminar esta fuente</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery.py"/>
        <source>Show on map</source>
        <translation>Ver en el mapa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery.py"/>
        <location filename="../../terrainav_plugin/panel/imagery_list.py"/>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>Source</source>
        <translation>Fuente</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery.py"/>
        <source>This project</source>
        <translation>Este proyecto</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery.py"/>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>URL</source>
        <translation>URL</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery.py"/>
        <source>URL template</source>
        <translation>Plantilla de URL</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery.py"/>
        <source>URL template…</source>
        <translation>Plantilla de URL…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery.py"/>
        <source>Where the images come from; type a part of its name to find it</source>
        <translation>De dónde vienen las imágenes; teclee parte de su nombre para encontrarla</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery.py"/>
        <source>Your own sources</source>
        <translation>Fuentes propias</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery.py"/>
        <source>date</source>
        <translation>fecha</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery_dialog.py"/>
        <location filename="../../terrainav_plugin/panel/imagery_list.py"/>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>Name</source>
        <translation>Nombre</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery_dialog.py"/>
        <source>Name of the imagery, and of its folder</source>
        <translation>Nombre de la fuente y de su carpeta</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery_dialog.py"/>
        <source>TerrAInav: add imagery</source>
        <translation>TerrAInav: añadir fuente de imágenes</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery_dialog.py"/>
        <source>TerrAInav: imagery</source>
        <translation>TerrAInav: fuente de imágenes</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery_dialog.py"/>
        <source>imagery “{name}”: is there already</source>
        <translation>fuente «{name}»: ya existe</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery_list.py"/>
        <source>Add imagery…</source>
        <translation>Añadir imágenes…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery_list.py"/>
        <source>Capture another date or source over the same ground, into a folder of its own</source>
        <translation>Capturar otra fecha o fuente sobre el mismo terreno, en una carpeta propia</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery_list.py"/>
        <source>Change the selected imagery</source>
        <translation>Cambiar la fuente seleccionada</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery_list.py"/>
        <source>Change…</source>
        <translation>Cambiar…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery_list.py"/>
        <source>Date, type</source>
        <translation>Fecha, tipo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery_list.py"/>
        <source>Remove</source>
        <translation>Quitar</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery_list.py"/>
        <source>Remove the selected imagery from the mission</source>
        <translation>Quitar de la misión la fuente seleccionada</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery_list.py"/>
        <source>Rename</source>
        <translation>Renombrar</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery_list.py"/>
        <source>Rename the selected imagery, and its folder</source>
        <translation>Renombrar la fuente seleccionada y su carpeta</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/imagery_list.py"/>
        <source>as above</source>
        <translation>la de arriba</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/layers.py"/>
        <source>One class</source>
        <translation>Una clase</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/layers.py"/>
        <source>Separate several with ;</source>
        <translation>Separe varios con ;</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/layers.py"/>
        <source>Vector file</source>
        <translation>Archivo vectorial</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/layers.py"/>
        <source>Vector files (*)</source>
        <translation>Archivos vectoriales (*)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/offers.py"/>
        <source>None</source>
        <translation>Ninguno</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>All settings except keys, which stay as they are</source>
        <translation>Todo salvo las claves, que se mantienen</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>At most</source>
        <translation>Como máximo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>Authentication configuration</source>
        <translation>Configuración de autenticación</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>Cache of tiles</source>
        <translation>Caché de teselas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>Clear all</source>
        <translation>Vaciar todo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>Clear selected</source>
        <translation>Vaciar lo seleccionado</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>Configuration for {title}</source>
        <translation>Configuración de {title}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>Connections at once</source>
        <translation>Conexiones simultáneas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>Feet (international)</source>
        <translation>Pies (internacionales)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>Folder for backgrounds</source>
        <translation>Carpeta de los fondos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>Folder for missions</source>
        <translation>Carpeta de las misiones</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>Folder of the cache</source>
        <translation>Carpeta de la caché</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>Heights in</source>
        <translation>Alturas en</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>Images of the synthetic landscape that are shown as background</source>
        <translation>Imágenes del paisaje sintético que se muestran como fondo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>Images over relief by</source>
        <translation>Imágenes sobre el relieve con</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>Keys and authentication</source>
        <translation>Claves y autenticación</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>Keys are stored encrypted in QGIS's authentication database, each as the password of a Basic configuration. TerrAInav saves only the configuration's id; no project, mission or layer contains a key.</source>
        <translation>Las claves se guardan cifradas en la base de datos de autenticación de QGIS, cada una como contraseña de una configuración básica. TerrAInav solo guarda el identificador de la configuración; ningún proyecto, misión o capa contiene una clave.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>Metres</source>
        <translation>Metros</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>New missions are captured into folders below this one</source>
        <translation>Las misiones nuevas se capturan en carpetas dentro de esta</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>Not kept: {problem}</source>
        <translation>No se ha guardado: {problem}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>Requests under way at once; fewer where a provider says so</source>
        <translation>Peticiones simultáneas; menos donde un proveedor lo indica</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>Reset to defaults</source>
        <translation>Restablecer valores predeterminados</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>SHA-256 of tiles that show no imagery, 16 digits or more of each, with spaces between them</source>
        <translation>SHA-256 de las teselas que no muestran imágenes, 16 dígitos o más de cada una, separados por espacios</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>Shows what is in the cache, and clears some or all of it</source>
        <translation>Muestra lo que hay en la caché, y la vacía en parte o del todo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>Size</source>
        <translation>Tamaño</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>Size limit of the cache in MB; beyond it, the least recently used tiles are deleted</source>
        <translation>Límite de tamaño de la caché en MB; al superarlo se borran las teselas usadas hace más tiempo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>Sources that need a key or are authenticated, and the configurations that hold it</source>
        <translation>Fuentes que necesitan una clave o autenticación, y las configuraciones que la contienen</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>TerrAInav: cache</source>
        <translation>TerrAInav: caché</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>Tiles that providers allow to be stored; they are not requested again</source>
        <translation>Teselas que los proveedores permiten guardar; no se vuelven a pedir</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>Unit of heights above ground: m or ft</source>
        <translation>Unidad de las alturas sobre el terreno: m o ft</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>View or clear…</source>
        <translation>Ver o vaciar…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>settings</source>
        <translation>configuración</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>sources</source>
        <translation>fuentes</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>{folder}: cannot be a folder ({reason})</source>
        <translation>{folder}: no puede ser una carpeta ({reason})</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>{folder}: cannot be written to; choose another</source>
        <translation>{folder}: no se puede escribir en ella; elija otra</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>{folder}: must be an absolute path, such as {example}</source>
        <translation>{folder}: debe ser una ruta absoluta, como {example}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>{folder}: {file} is a file; choose a folder</source>
        <translation>{folder}: {file} es un archivo; elija una carpeta</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>{size} freed.</source>
        <translation>{size} liberados.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/options_page.py"/>
        <source>{size} of at most {limit} in {folder}</source>
        <translation>{size} de un máximo de {limit} en {folder}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/planning.py"/>
        <source>Cleared because rows and images have new numbers: {entries}.</source>
        <translation>Vaciado, pues las pasadas y las imágenes tienen ahora otros números: {entries}.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/planning.py"/>
        <source>The entries changed while the plan was being computed: press the button again.</source>
        <translation>Las entradas han cambiado mientras se calculaba el plan: pulse el botón de nuevo.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/planning.py"/>
        <source>The mission could not be planned.</source>
        <translation>No se ha podido planificar la misión.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/planning.py"/>
        <source>Unexpected error: {error}</source>
        <translation>Error inesperado: {error}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/planning.py"/>
        <source>no area yet; draw a box or enter coordinates</source>
        <translation>aún no hay área; dibuje un recuadro o introduzca coordenadas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/planning.py"/>
        <source>not timed during a capture</source>
        <translation>sin medir mientras hay una captura en curso</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/presets.py"/>
        <source>Fills in suitable values for a purpose; you can change each of them</source>
        <translation>Rellena valores adecuados para un fin; todos se pueden cambiar</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/presets.py"/>
        <source>Preset</source>
        <translation>Ajuste</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/runs.py"/>
        <source>Cancel (finished images are kept)</source>
        <translation>Cancelar (las imágenes terminadas se conservan)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/runs.py"/>
        <source>Capture only the failed images again</source>
        <translation>Capturar de nuevo solo las imágenes fallidas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/runs.py"/>
        <source>Clear finished</source>
        <translation>Quitar terminadas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/runs.py"/>
        <source>Open in the Dataset window, which cleans, splits, exports and shows it</source>
        <translation>Abrir en la ventana Conjunto de datos, que lo limpia, divide, exporta y muestra</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/runs.py"/>
        <source>Open the folder of the images</source>
        <translation>Abrir la carpeta de las imágenes</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/runs.py"/>
        <source>Opening; making the mosaic…</source>
        <translation>Abriendo; creando el mosaico…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/runs.py"/>
        <source>Opening…</source>
        <translation>Abriendo…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/runs.py"/>
        <source>Pause this capture</source>
        <translation>Pausar esta captura</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/runs.py"/>
        <source>Remove finished captures from the list (files are kept)</source>
        <translation>Quitar de la lista las capturas terminadas (los archivos se conservan)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/runs.py"/>
        <source>Remove from list (files are kept)</source>
        <translation>Quitar de la lista (los archivos se conservan)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/runs.py"/>
        <source>Resume this capture</source>
        <translation>Reanudar esta captura</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/runs.py"/>
        <source>Stop opening this dataset</source>
        <translation>Dejar de abrir este conjunto de datos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/runs.py"/>
        <source>Zoom the map to this mission</source>
        <translation>Hacer zoom a esta misión en el mapa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>&amp;GSD</source>
        <translation>&amp;GSD</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Accuracy</source>
        <translation>Exactitud</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Align</source>
        <translation>Alinear</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Align to longest side</source>
        <translation>Alinear con el lado más largo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Also set: {text}</source>
        <translation>También definido: {text}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Attitude, ground and time</source>
        <translation>Actitud, terreno y hora</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Auto</source>
        <translation>Auto</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>Automatic</source>
        <translation>Automático</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Camera realism</source>
        <translation>Realismo de la cámara</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Choose a layer and its field of classes</source>
        <translation>Elegir una capa y su campo de clases</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Choose footprints of buildings</source>
        <translation>Elegir plantas de edificios</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Distortion</source>
        <translation>Distorsión</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Enter the greatest speed for the minimum image interval, and for the exposure time and motion blur, which are in the tab Advanced; at most 15 m/s, as DJI's drones</source>
        <translation>Introduce la mayor velocidad para el intervalo mínimo entre imágenes y para el tiempo de exposición y el desenfoque, que están en la pestaña Avanzado; como máximo 15 m/s, como los drones de DJI</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Fills in the effects of a kind of camera; a test shot shows them beside the ideal image</source>
        <translation>Rellena los efectos de un tipo de cámara; una toma de prueba los muestra junto a la imagen ideal</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Flight path</source>
        <translation>Trayectoria de vuelo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Folder</source>
        <translation>Carpeta</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Folder for the images</source>
        <translation>Carpeta para las imágenes</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Folder for the images; the mission takes its name on the map</source>
        <translation>Carpeta para las imágenes; la misión toma su nombre en el mapa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Greyscale</source>
        <translation>Escala de grises</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Ground sample distance (GSD) of the camera, straight down, in cm per px (inches with feet). Height and GSD depend on each other; the one entered last is kept. The estimates show the GSD of the source.</source>
        <translation>Distancia de muestreo del terreno (GSD) de la cámara, mirando en vertical, en cm por px (pulgadas si se usan pies). La altura y la GSD dependen una de otra; se conserva la última introducida. La estimación muestra la GSD de la fuente.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Gusts move and turn the camera at every exposure; images show what the moved camera sees</source>
        <translation>Las ráfagas mueven y giran la cámara en cada exposición; las imágenes muestran lo que ve la cámara desplazada</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Height above ground (AGL), in the unit selected beside it</source>
        <translation>Altura sobre el terreno (AGL), en la unidad elegida al lado</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Height of the resized images in pixels (px)</source>
        <translation>Altura de las imágenes redimensionadas en píxeles (px)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Kind of camera</source>
        <translation>Tipo de cámara</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Labels and buildings</source>
        <translation>Etiquetas y edificios</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>List the image sensors</source>
        <translation>Mostrar la lista de sensores de imagen</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Metres or international feet, for this height and for lengths and areas in the estimates</source>
        <translation>Metros o pies internacionales, para esta altura y para longitudes y áreas de la estimación</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Output</source>
        <translation>Salida</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Pick rows to skip, by clicks on the preview</source>
        <translation>Elegir pasadas por omitir, con clics en la vista previa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Pick the last images of sorties, by clicks on the preview</source>
        <translation>Elegir las últimas imágenes de las salidas, con clics en la vista previa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>Pixels</source>
        <translation>Píxeles</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Profile</source>
        <translation>Perfil</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Resize every image to the width and height below, in pixels (px)</source>
        <translation>Redimensionar todas las imágenes a la anchura y altura de abajo, en píxeles (px)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Set take-off point, by a click on the map</source>
        <translation>Fijar el punto de despegue con un clic en el mapa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Settings in the mission file that the panel cannot show</source>
        <translation>Ajustes del archivo de la misión que el panel no puede mostrar</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Shortest flight</source>
        <translation>Vuelo más corto</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Show or hide the coefficients of the lens</source>
        <translation>Mostrar u ocultar los coeficientes del objetivo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Show the heights of flight, ground and surface along the flight, below the map</source>
        <translation>Mostrar bajo el mapa las alturas del vuelo, del terreno y de la superficie a lo largo del vuelo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Source resolution</source>
        <translation>Resolución de la fuente</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Turn the rows to suit the area</source>
        <translation>Girar las pasadas para que se ajusten al área</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Width of the resized images in pixels (px)</source>
        <translation>Anchura de las imágenes redimensionadas en píxeles (px)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Wind</source>
        <translation>Viento</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>With {px} px along the image's longer side, this means flying {height} above ground. To fly higher, increase “Image's longer side” under Camera.</source>
        <translation>Con {px} px en el lado mayor de la imagen, esto significa volar a {height} sobre el terreno. Para volar más alto, aumente «Lado mayor de la imagen» en Cámara.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Write one grey channel instead of three colour channels</source>
        <translation>Escribir un canal de gris en lugar de tres de color</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>Zoom</source>
        <translation>Zoom</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Zoom of the source. Automatic: the zoom whose GSD is closest to the camera's, which follows from the height and the image's longer side.</source>
        <translation>Zoom de la fuente. Automático: el zoom cuya GSD más se acerca a la de la cámara, que resulta de la altura y del lado mayor de la imagen.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>Zoom {native} is the source's native resolution, with a GSD of {size}. Each zoom below it, down to {least}, doubles the GSD.</source>
        <translation>El zoom {native} es la resolución nativa de la fuente, con una GSD de {size}. Cada zoom inferior, hasta {least}, duplica la GSD.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>all, or the colour bands</source>
        <translation>todas, o las de color</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>as the source says</source>
        <translation>lo que diga la fuente</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>cm</source>
        <translation>cm</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>front</source>
        <translation>longitudinal</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>ideal</source>
        <translation>ideal</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>in</source>
        <translation>in</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>none: from the first capture to the last</source>
        <translation>ninguno: de la primera captura a la última</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>reset</source>
        <translation>restablecer</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>same as the elevation</source>
        <translation>la misma que la elevación</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>side</source>
        <translation>transversal</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/sections.py"/>
        <source>the source's own</source>
        <translation>el de la fuente</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source> a second</source>
        <translation> por segundo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>&amp;Find layers</source>
        <translation>&amp;Buscar capas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>&amp;Test</source>
        <translation>&amp;Probar</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>256 px</source>
        <translation>256 px</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>512 px</source>
        <translation>512 px</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>API key for {key} in the address; kept in QGIS's authentication database</source>
        <translation>Clave de API que sustituye a {key} en la dirección; se guarda en la base de datos de autenticación de QGIS</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>Address of the provider's terms of use</source>
        <translation>Dirección de las condiciones de uso del proveedor</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>Address of the tiles with {z}, {x} and {y} or {-y}, or of a WMTS, WMS, ArcGIS REST service or OGC API; {key} stands for an API key</source>
        <translation>Dirección de las teselas con {z}, {x} e {y} o {-y}, o de un servicio WMTS, WMS o ArcGIS REST o de una OGC API; {key} representa una clave de API</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>Ask the service what it is, and which layers it offers</source>
        <translation>Preguntar al servicio de qué tipo es y qué capas ofrece</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>Asking the service…</source>
        <translation>Consultando el servicio…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>Asking {name} for its layers</source>
        <translation>Consultando a {name} por sus capas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>Attribution</source>
        <translation>Atribución</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>Connections</source>
        <translation>Conexiones</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>Coordinate reference system of the images</source>
        <translation>Sistema de referencia de coordenadas de las imágenes</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>Credit that goes into every image's metadata</source>
        <translation>Crédito que figura en los metadatos de cada imagen</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>Default date</source>
        <translation>Fecha predeterminada</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>Default value of {date} in the address</source>
        <translation>Valor predeterminado de {date} en la dirección</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>Fetch one tile and show it</source>
        <translation>Descargar una tesela y mostrarla</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>Fetching a tile of {name}</source>
        <translation>Descargando una tesela de {name}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>Highest zoom</source>
        <translation>Zoom máximo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>Highest zoom with native detail, 0 to 30</source>
        <translation>Zoom máximo con detalle propio, de 0 a 30</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>Its name in missions and on the command line: lower-case letters, digits, - and _</source>
        <translation>La identifica en las misiones y en la línea de órdenes: letras minúsculas, cifras, - y _</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>Key</source>
        <translation>Clave</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>Layer</source>
        <translation>Capa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>Layers that the service offers</source>
        <translation>Capas que ofrece el servicio</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>Leave it ticked only where the provider's terms allow storing</source>
        <translation>Déjelo marcado solo si las condiciones del proveedor permiten almacenarlas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>Licence</source>
        <translation>Licencia</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>Licence of the imagery, such as CC BY 4.0</source>
        <translation>Licencia de las imágenes, como CC BY 4.0</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>Part of a layer's title or name</source>
        <translation>Parte del título o nombre de una capa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>Reference system</source>
        <translation>Sistema de referencia</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <location filename="../../terrainav_plugin/processing/capture.py"/>
        <source>Requests</source>
        <translation>Peticiones</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>Requests a second, as many as the provider allows</source>
        <translation>Peticiones por segundo, tantas como permita el proveedor</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>Requests under way at once, as many as the provider allows</source>
        <translation>Peticiones simultáneas, tantas como permita el proveedor</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>Search</source>
        <translation>Buscar</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>Terms</source>
        <translation>Condiciones</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>TerrAInav: add source</source>
        <translation>TerrAInav: añadir fuente</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>TerrAInav: layer of {name}</source>
        <translation>TerrAInav: capa de {name}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>The key in its address will be kept in QGIS's authentication database.</source>
        <translation>La clave de su dirección se guardará en la base de datos de autenticación de QGIS.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>Tile size</source>
        <translation>Tamaño de tesela</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>Tile {tile}: {width} x {height} px, {format}, {kilobytes} kB, in {seconds} s. Zoom {least} to {most}. Attribution: {attribution}.</source>
        <translation>Tesela {tile}: {width} x {height} px, {format}, {kilobytes} kB, en {seconds} s. Zoom de {least} a {most}. Atribución: {attribution}.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>Tiles may be kept in the cache</source>
        <translation>Las teselas se pueden guardar en la caché</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>Title</source>
        <translation>Título</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>What you call it</source>
        <translation>Cómo quiere llamarla</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>Width and height of a tile</source>
        <translation>Anchura y altura de una tesela</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>address</source>
        <translation>dirección</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>must be lower-case letters, digits, hyphens and underscores, at most 64</source>
        <translation>debe constar de minúsculas, cifras, guiones y guiones bajos, 64 como máximo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>none stated</source>
        <translation>no indicada</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>nothing was answered</source>
        <translation>no hubo respuesta</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>unknown format</source>
        <translation>formato desconocido</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>{count} layers</source>
        <translation>{count} capas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>{count} more</source>
        <translation>{count} más</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>{layer} ({service})</source>
        <translation>{layer} ({service})</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_dialogs.py"/>
        <source>“{name}” is taken; choose another name</source>
        <translation>«{name}» ya está en uso; elija otro nombre</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_list.py"/>
        <source>Remove “{title}” from your sources? Captured images stay.</source>
        <translation>¿Eliminar «{title}» de las fuentes propias? Las imágenes capturadas se quedan.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_list.py"/>
        <source>Some of your own sources are left out: {reason}</source>
        <translation>Algunas de las fuentes propias se omiten: {reason}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/source_list.py"/>
        <source>TerrAInav: remove source</source>
        <translation>TerrAInav: eliminar fuente</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/speed.py"/>
        <source>Airspeed {speed} m/s. Greatest speed: {limits}.</source>
        <translation>Velocidad aérea {speed} m/s. Velocidad máxima: {limits}.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/speed.py"/>
        <source>The airspeed stays as it is.</source>
        <translation>La velocidad aérea queda como está.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/panel/start.py"/>
        <source>{time} {zone}, local time of this computer</source>
        <translation>{time} {zone}, hora local de este equipo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/plan_features.py"/>
        <source>1 feature</source>
        <translation>1 elemento</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/plan_features.py"/>
        <source>Classes: {count}.</source>
        <translation>Clases: {count}.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/plan_features.py"/>
        <source>Features without a value, which are ignored: {count}.</source>
        <translation>Elementos sin valor, que se ignoran: {count}.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/plan_features.py"/>
        <source>In the planned area</source>
        <translation>En la zona planificada</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/plan_features.py"/>
        <source>No building stands in any image.</source>
        <translation>Ningún edificio aparece en ninguna imagen.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/plan_features.py"/>
        <source>No label lies in any image.</source>
        <translation>Ninguna etiqueta aparece en ninguna imagen.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/plan_features.py"/>
        <source>Of the nearest {read} of {around} features in the planned area</source>
        <translation>De los {read} elementos más cercanos, de {around} en la zona planificada</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/plan_features.py"/>
        <source>Values of {field} that cannot be read: {count} ({examples}).</source>
        <translation>Valores de {field} que no se pueden leer: {count} ({examples}).</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/plan_features.py"/>
        <source>default height ({height} m)</source>
        <translation>altura predeterminada ({height} m)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/plan_features.py"/>
        <source>of CityJSON</source>
        <translation>de CityJSON</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/plan_features.py"/>
        <source>with height</source>
        <translation>con altura</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/plan_features.py"/>
        <source>with levels</source>
        <translation>con plantas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/plan_features.py"/>
        <source>{count} features</source>
        <translation>{count} elementos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/plan_features.py"/>
        <source>{count} left out (no area or length)</source>
        <translation>{count} omitidos (sin área ni longitud)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/plan_features.py"/>
        <source>{count} repaired (self-crossing)</source>
        <translation>{count} reparados (se cruzaban a sí mismos)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/plan_features.py"/>
        <source>{name}: {count} buildings.</source>
        <translation>{name}: {count} edificios.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/plan_features.py"/>
        <source>{where}: {height} with a height, {levels} with levels, {default} of the default height.</source>
        <translation>{where}: {height} con altura, {levels} con plantas, {default} con la altura predeterminada.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/planner.py"/>
        <source>not timed, as the images are large</source>
        <translation>sin medir, porque las imágenes son grandes</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/plugin.py"/>
        <source>&amp;Capture</source>
        <translation>&amp;Capturar</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/plugin.py"/>
        <source>&amp;Help</source>
        <translation>A&amp;yuda</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/plugin.py"/>
        <source>&amp;Live view</source>
        <translation>Vista &amp;en directo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/plugin.py"/>
        <source>&amp;Settings…</source>
        <translation>Con&amp;figuración…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/plugin.py"/>
        <source>&amp;Test shot</source>
        <translation>&amp;Toma de prueba</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/plugin.py"/>
        <source>&amp;View images</source>
        <translation>&amp;Ver imágenes</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/plugin.py"/>
        <source>D&amp;ataset…</source>
        <translation>Conjunto de dato&amp;s…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/plugin.py"/>
        <source>Label &amp;images with this layer</source>
        <translation>Etiquetar &amp;imágenes con esta capa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/plugin.py"/>
        <source>Make &amp;benchmark…</source>
        <translation>Crear &amp;banco de pruebas…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/plugin.py"/>
        <source>Mission &amp;panel</source>
        <translation>&amp;Panel de misión</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/plugin.py"/>
        <source>Preview &amp;footprints</source>
        <translation>Vista previa de &amp;huellas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/plugin.py"/>
        <source>Sc&amp;ore benchmark…</source>
        <translation>Puntuar banc&amp;o de pruebas…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/plugin.py"/>
        <location filename="../../terrainav_plugin/processing/algorithm.py"/>
        <source>TerrAInav needs Python packages that this QGIS lacks: {packages}.</source>
        <translation>TerrAInav necesita paquetes de Python que faltan en este QGIS: {packages}.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/plugin.py"/>
        <source>TerrAInav: {text}</source>
        <translation>TerrAInav: {text}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/preview/background.py"/>
        <source>Drawing the synthetic landscape</source>
        <translation>Dibujando el paisaje sintético</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/preview/background.py"/>
        <source>no reason given</source>
        <translation>no se indica el motivo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/preview/background.py"/>
        <source>{title} cannot be shown: {reason}</source>
        <translation>no se puede mostrar {title}: {reason}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/preview/layers.py"/>
        <source>Buildings</source>
        <translation>Edificios</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/preview/layers.py"/>
        <source>Capture centres</source>
        <translation>Centros de captura</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/preview/layers.py"/>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>Flight line</source>
        <translation>Línea de vuelo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/preview/layers.py"/>
        <location filename="../../terrainav_plugin/processing/capture.py"/>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>Footprints</source>
        <translation>Huellas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/preview/layers.py"/>
        <source>Images per place</source>
        <translation>Imágenes por lugar</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/preview/layers.py"/>
        <source>Overlap count</source>
        <translation>Número de solapes</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/preview/layers.py"/>
        <source>Planned images</source>
        <translation>Imágenes planificadas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/preview/layers.py"/>
        <source>Sortie {number}</source>
        <translation>Salida {number}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/preview/layers.py"/>
        <source>at {time} UTC</source>
        <translation>a las {time} UTC</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/preview/layers.py"/>
        <source>feature {number}</source>
        <translation>elemento {number}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/preview/layers.py"/>
        <source>mean overlap count here: {count}</source>
        <translation>imágenes que muestran un punto de aquí, en promedio: {count}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/preview/layers.py"/>
        <source>overlap count at the centre: {count}</source>
        <translation>imágenes que muestran su centro: {count}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/preview/layers.py"/>
        <source>the horizon is in the image</source>
        <translation>el horizonte está en la imagen</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/preview/layers.py"/>
        <source>{count} more classes</source>
        <translation>{count} clases más</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/preview/layers.py"/>
        <source>{gsd} cm per pixel, {height} m above ground</source>
        <translation>{gsd} cm por píxel, {height} m sobre el terreno</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/preview/layers.py"/>
        <source>{length} km, {count} images, from {start} to {end} UTC</source>
        <translation>{length} km, {count} imágenes, de {start} a {end} UTC</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/preview/layers.py"/>
        <source>{title} (the nearest {most} of {count})</source>
        <translation>{title} (los {most} más cercanos de {count})</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/preview/picking.py"/>
        <source>A split needs a take-off point, where each sortie begins and ends.</source>
        <translation>Una división requiere un punto de despegue, donde empieza y termina cada salida.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/preview/picking.py"/>
        <source>Click a row of the preview to skip it, and again to bring it back; Shift-click takes all rows up to it.</source>
        <translation>Haga clic en una pasada de la vista previa para omitirla y otra vez para recuperarla; con Mayús se toman todas hasta ella.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/preview/picking.py"/>
        <source>Click the last image of a sortie; click it again to go on without landing.</source>
        <translation>Haga clic en la última imagen de una salida; otro clic en ella y el vuelo sigue sin aterrizar.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/preview/picking.py"/>
        <source>The plan is still being worked out.</source>
        <translation>El plan aún se está calculando.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/preview/picking.py"/>
        <source>There is no planned image, or the flight ends with it.</source>
        <translation>Allí no hay ninguna imagen planificada, o el vuelo termina con ella.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/preview/picking.py"/>
        <source>There is no row of planned images.</source>
        <translation>Allí no hay ninguna pasada de imágenes planificadas.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/preview/picking.py"/>
        <source>bring rows back</source>
        <translation>recuperar pasadas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/preview/picking.py"/>
        <source>skip rows</source>
        <translation>omitir pasadas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/preview/picking.py"/>
        <source>split the flight</source>
        <translation>dividir el vuelo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/algorithm.py"/>
        <location filename="../../terrainav_plugin/processing/capture.py"/>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Dataset folder</source>
        <translation>Carpeta del conjunto de datos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/algorithm.py"/>
        <source>Datasets</source>
        <translation>Conjuntos de datos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/algorithm.py"/>
        <source>Stopped: {reason}</source>
        <translation>Detenido: {reason}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/algorithm.py"/>
        <source>cannot continue ({error})</source>
        <translation>no se puede continuar ({error})</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/algorithm.py"/>
        <source>{title} {value}: has a character that is not allowed in files or file names</source>
        <translation>{title} {value}: tiene un carácter que los archivos y sus nombres no pueden tener</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/algorithm.py"/>
        <source>{title} {value}: must be a number</source>
        <translation>{title} {value}: debe ser un número</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/algorithm.py"/>
        <source>{title} {value}: must be a whole number of 32 bits</source>
        <translation>{title} {value}: debe ser un número entero de 32 bits</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/areas.py"/>
        <source>The area has {count} polygons: each gets separate rows.</source>
        <translation>El área tiene {count} polígonos: cada uno tiene sus propias pasadas.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/areas.py"/>
        <source>area {name}</source>
        <translation>área {name}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/areas.py"/>
        <source>area {name}: has no features</source>
        <translation>área {name}: no tiene objetos espaciales</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/areas.py"/>
        <source>area {name}: has no field {field}</source>
        <translation>área {name}: no tiene el campo {field}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/areas.py"/>
        <source>area {name}: no such layer</source>
        <translation>área {name}: no existe tal capa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/areas.py"/>
        <source>extent {text}: cannot be read; must be xmin,xmax,ymin,ymax [EPSG:code]</source>
        <translation>extensión {text}: no se puede leer; debe ser xmin,xmax,ymin,ymax [EPSG:código]</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/areas.py"/>
        <source>extent: cannot be transformed to latitude and longitude ({error})</source>
        <translation>extensión: no se puede transformar a latitud y longitud ({error})</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/areas.py"/>
        <source>fields for tilt and gimbal pitch given: needs one of the two</source>
        <translation>campos de inclinaciones y de cabeceos del gimbal a la vez: se necesita uno de los dos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/areas.py"/>
        <source>no-fly areas {name}</source>
        <translation>zonas de exclusión {name}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/areas.py"/>
        <source>no-fly areas {name}: no such layer</source>
        <translation>zonas de exclusión {name}: no existe esa capa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/areas.py"/>
        <source>{layer}: has no polygons</source>
        <translation>{layer}: no tiene polígonos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/areas.py"/>
        <source>{layer}: {problem}</source>
        <translation>{layer}: {problem}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>A file of predictions is a CSV with the column query, and references (the best tile first, with spaces between them) or lat_deg and lon_deg.</source>
        <translation>Un archivo de predicciones es un CSV con la columna query, y references (primero la mejor tesela, separadas por espacios) o lat_deg y lon_deg.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>A folder made by “Make a benchmark”.</source>
        <translation>Como la deja «Crear un banco de pruebas».</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>A new folder, or the folder of this benchmark, to resume it.</source>
        <translation>Una carpeta nueva, o una que contenga este banco de pruebas, para continuarlo.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <location filename="../../terrainav_plugin/processing/capture.py"/>
        <source>Add the results to the project</source>
        <translation>Añadir los resultados al proyecto</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Average precision</source>
        <translation>Precisión media</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Baseline</source>
        <translation>Método de referencia</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Benchmark folder</source>
        <translation>Carpeta del banco de pruebas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Captures queries, the views of the mission, and the reference in which to find them: one mosaic, and tiles of it. Tables give the position of each query and the right tiles.</source>
        <translation>Captura consultas, que son las vistas de la misión, y la referencia en la que hay que encontrarlas: un mosaico y sus teselas. Las tablas dicen dónde se tomó cada consulta y qué teselas son correctas.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Errors of the queries</source>
        <translation>Errores de las consultas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Errors of {name}</source>
        <translation>Errores de {name}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Every query is taken from each of them. Their names are those of the layers.</source>
        <translation>Cada consulta se toma de cada uno de ellos. Se llaman como sus capas.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Files of buildings in which to find the queries as well, with semicolons between them, such as footprints or CityJSON. They are copied into the benchmark's folder, and the queries have masks of the mission's buildings, or of these if it has none. Needs an elevation.</source>
        <translation>Archivos de edificios en los que también se localizan las consultas, separados por punto y coma, como contornos o CityJSON. Se copian en la carpeta del banco de pruebas, y las consultas tienen máscaras de los edificios de la misión, o de estos si no tiene ninguno. Requiere una elevación.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Folder of the scores</source>
        <translation>Carpeta de las puntuaciones</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Found within 1 m (share)</source>
        <translation>Encontradas a menos de 1 m (proporción)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Found within 10 m (share)</source>
        <translation>Encontradas a menos de 10 m (proporción)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Found within 20 m (share)</source>
        <translation>Encontradas a menos de 20 m (proporción)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Found within 3 m (share)</source>
        <translation>Encontradas a menos de 3 m (proporción)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Found within 5 m (share)</source>
        <translation>Encontradas a menos de 5 m (proporción)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Ground around that of the queries. If empty, the width of the widest tile.</source>
        <translation>Terreno alrededor del de las consultas. Si está vacío, tanto como el ancho de la tesela más ancha.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>If empty, a folder inside the benchmark's, named after the baseline or file of predictions, and the part.</source>
        <translation>Si está vacía, una dentro de la del banco de pruebas, con el nombre del método de referencia o del archivo de predicciones, y de la parte.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <location filename="../../terrainav_plugin/processing/capture.py"/>
        <source>Images that could not be captured</source>
        <translation>Imágenes que no se pudieron capturar</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Intersection over union of nearly right tiles</source>
        <translation>Intersección sobre unión de las teselas casi correctas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Intersection over union of right tiles</source>
        <translation>Intersección sobre unión de las teselas correctas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Its answers are scored unless a file of predictions is given. sift and orb need OpenCV.</source>
        <translation>Se evalúan sus respuestas si no se indica un archivo de predicciones. sift y orb necesitan OpenCV.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Leave out queries beyond the imagery</source>
        <translation>Omitir consultas fuera de las imágenes</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Make a benchmark</source>
        <translation>Crear un banco de pruebas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Margin of the reference (metres)</source>
        <translation>Margen de la referencia (metros)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Median error (metres)</source>
        <translation>Error mediano (metros)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Minimum for a nearly right tile.</source>
        <translation>A partir de la cual una tesela es casi correcta.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Minimum for a right tile: the ground shared by tile and query, over the ground of both.</source>
        <translation>A partir de la cual una tesela es correcta: terreno que comparten tesela y consulta, entre el terreno de ambas.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>One per line, beside the rasters: {form} If neither is given, that of the mission.</source>
        <translation>Uno por línea, además de los ráster: {form} Si no se indica nada, las imágenes de la misión.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Only the queries of one part, found among its tiles. If empty, all.</source>
        <translation>Solo las consultas de una parte, buscadas entre sus teselas. Si está vacío, todas.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Overlap of tiles (percent)</source>
        <translation>Solape de las teselas (porcentaje)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>PDM@1</source>
        <translation>PDM@1</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Part</source>
        <translation>Parte</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Parts</source>
        <translation>Partes</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Predictions</source>
        <translation>Predicciones</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Queries</source>
        <translation>Consultas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Queries for the test</source>
        <translation>Consultas de prueba</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Queries for training</source>
        <translation>Consultas de entrenamiento</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Queries for validation</source>
        <translation>Consultas de validación</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Queries from one imagery to find in another, with exact labels.</source>
        <translation>Consultas de unas imágenes que hay que encontrar en otras, con etiquetas exactas.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Queries in no part</source>
        <translation>Consultas en ninguna parte</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Queries of each imagery left out, as they show ground beyond the imagery: {n}</source>
        <translation>Consultas omitidas de cada imagen, que ven más allá de las imágenes: {n}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Queries of {name}</source>
        <translation>Consultas de {name}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Queries that show ground beyond their imagery or the reference are left out: they would fail.</source>
        <translation>Se omiten las consultas que ven más allá de sus propias imágenes o de las de la referencia: fallarían.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Queries without a right tile</source>
        <translation>Consultas sin tesela correcta</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Queries: imagery by name</source>
        <translation>Consultas: imágenes por nombre</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Queries: rasters</source>
        <translation>Consultas: ráster</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Recall@1 (share)</source>
        <translation>Recall@1 (proporción)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Recall@10 (share)</source>
        <translation>Recall@10 (proporción)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Recall@5 (share)</source>
        <translation>Recall@5 (proporción)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Reference</source>
        <translation>Referencia</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Reference: buildings</source>
        <translation>Referencia: edificios</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Reference: imagery by name</source>
        <translation>Referencia: imágenes por nombre</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Reference: raster</source>
        <translation>Referencia: ráster</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Runs a baseline or reads predictions, scores them, and shows the errors on the map.</source>
        <translation>Ejecuta un método de referencia o lee predicciones, las evalúa y muestra los errores en el mapa.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>SDM@1 per metre</source>
        <translation>SDM@1 por metro</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>SOURCE, SOURCE@DATE or SOURCE:roadmap, with NAME= in front for another name.</source>
        <translation>FUENTE, FUENTE@FECHA o FUENTE:roadmap, con NOMBRE= delante para un nombre propio.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Score a benchmark</source>
        <translation>Puntuar un banco de pruebas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Scored instead of the baseline's answers.</source>
        <translation>Se evalúan en lugar de las respuestas del método de referencia.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Scores</source>
        <translation>Puntuaciones</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Scores answers to the queries of a benchmark: those of a baseline, which it runs, or those in a file. Writes a page, the figures, and the error of every query.</source>
        <translation>Evalúa respuestas a las consultas de un banco de pruebas: las de un método de referencia, que ejecuta, o las de un archivo. Escribe una página, las cifras y el error de cada consulta.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Share of a tile that its neighbour repeats.</source>
        <translation>Cuánto de una tesela vuelve a mostrar su vecina.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Take the queries and the reference from imagery of different dates, sources or kinds, as rasters or by source: SOURCE, SOURCE@DATE or SOURCE:roadmap, such as esri-wayback@2014-02-20, with NAME= in front for another name. world is the embedded landscape. Without imagery for the queries, the mission's is used.</source>
        <translation>Tome las consultas y la referencia de imágenes de fechas, fuentes o tipos distintos, como ráster o por fuente: FUENTE, FUENTE@FECHA o FUENTE:roadmap, por ejemplo esri-wayback@2014-02-20, con NOMBRE= delante para un nombre propio. world es el paisaje incorporado. Si no se indican imágenes de las consultas, son las de la misión.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>The answers have no positions: there are no errors to show on the map.</source>
        <translation>Las respuestas no tienen posiciones: no hay errores que mostrar en el mapa.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>The errors and the reference, if the algorithm runs in a project.</source>
        <translation>Los errores y la referencia, si el algoritmo se ejecuta en un proyecto.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>The imagery in which to find the queries; needed unless an imagery is given by name.</source>
        <translation>Aquello en lo que hay que encontrar las consultas; hace falta esto, o unas imágenes por nombre.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>The log shows what would be captured; nothing is captured.</source>
        <translation>El registro dice qué se capturaría; no se captura nada.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>The map shows the position of each query in the colour of its error, with a line to the position of the answer. To show scores again, choose their file of predictions.</source>
        <translation>El mapa muestra dónde se tomó cada consulta, en el color de su error, con una línea hasta donde la sitúa la respuesta. Para mostrar de nuevo unas puntuaciones, elija su archivo de predicciones.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>The page has no diagrams: QGIS's Python lacks the package matplotlib.</source>
        <translation>La página no tiene gráficos: al Python de QGIS le falta el paquete matplotlib.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>The reference and the footprints of the queries, if the algorithm runs in a project.</source>
        <translation>La referencia y las huellas de las consultas, si el algoritmo se ejecuta en un proyecto.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Tiles of the reference</source>
        <translation>Teselas de la referencia</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>Widths of tiles (metres)</source>
        <translation>Anchos de las teselas (metros)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>With buildings: found within 2 m and 2° (share)</source>
        <translation>Con edificios: localizadas a menos de 2 m y 2° (proporción)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>With buildings: found within 3 m and 3° (share)</source>
        <translation>Con edificios: localizadas a menos de 3 m y 3° (proporción)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>With buildings: found within 5 m and 5° (share)</source>
        <translation>Con edificios: localizadas a menos de 5 m y 5° (proporción)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>With buildings: intersection over union of masks (share)</source>
        <translation>Con edificios: intersección sobre unión de las máscaras (proporción)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>With cross-area only: minimum distance between the ground of two parts.</source>
        <translation>Solo con cross-area: distancia mínima entre el terreno de dos partes.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>With spaces between them. If empty, that of a square with the area of a query's ground.</source>
        <translation>Separados por espacios. Si está vacío, el de un cuadrado tan grande como lo que muestra una consulta.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>benchmark,localization,geolocalization,retrieval,query,reference,dataset,navigation,gnss</source>
        <translation>banco de pruebas,benchmark,localización,geolocalización,recuperación,consulta,referencia,conjunto de datos,navegación,gnss</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>benchmark,score,judge,recall,localization,error,predictions,baseline,sift,correlation</source>
        <translation>banco de pruebas,benchmark,puntuar,evaluar,recall,localización,error,predicciones,sift,correlación</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>cross-area: no ground is in two of the parts training, validation and test; same-area: all parts share one reference; none: no parts.</source>
        <translation>cross-area: ningún terreno está en dos partes (entrenamiento, validación y prueba); same-area: las consultas se reparten sobre una misma referencia; none: sin partes.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>ncc correlates the query, as seen vertically from above, with every place of the reference. sift and orb match features; they need OpenCV (the Python package opencv-python-headless). middle always answers with the middle of the reference, which every method has to beat.</source>
        <translation>ncc correlaciona la consulta, vista desde arriba, con cada lugar de la referencia. sift y orb emparejan rasgos; necesitan OpenCV (el paquete de Python opencv-python-headless). middle responde siempre el centro de la referencia: lo que todo método tiene que superar.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>nothing was written</source>
        <translation>no se ha escrito nada</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>prior answers with the simulated measurements as they are. silhouette moves the camera from there to where the buildings of the reference overlap the query's mask most; it needs a benchmark with buildings.</source>
        <translation>prior responde con las medidas simuladas tal como son. silhouette desplaza la cámara desde allí hasta donde los edificios de la referencia más se solapan con la máscara de la consulta; requiere un banco de pruebas con edificios.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>widths of tiles {text!r}: must be numbers, such as 200 400</source>
        <translation>anchos de teselas {text!r}: deben ser números, como 200 400</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>{count} references given: needs one, a raster or an imagery by name</source>
        <translation>se han indicado {count} referencias: hace falta una, un ráster o unas imágenes por nombre</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>{folder}: {imagery}; images: {images}, {width} x {height} px; requests: {requests}</source>
        <translation>{folder}: {imagery}; imágenes: {images}, {width} x {height} px; peticiones: {requests}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/benchmarks.py"/>
        <source>“Only count” shows the number of images and requests. Run it again into the same folder to resume an interrupted run. “Score a benchmark” then runs a baseline, or scores your own answers.</source>
        <translation>«Solo contar» dice cuántas imágenes y peticiones hacen falta. Ejecútelo de nuevo en la misma carpeta para continuar una ejecución interrumpida. «Puntuar un banco de pruebas» ejecuta después un método de referencia, o evalúa sus propias respuestas.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/capture.py"/>
        <source>A new folder, or the folder of this mission, to resume it.</source>
        <translation>Una carpeta nueva, o una que contiene esta misión, para continuarla.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/capture.py"/>
        <source>Capture a mission</source>
        <translation>Capturar una misión</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/capture.py"/>
        <source>Capture failed images again</source>
        <translation>Capturar de nuevo las imágenes fallidas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/capture.py"/>
        <source>Captured images, {name}</source>
        <translation>Imágenes capturadas, {name}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/capture.py"/>
        <source>Captures again the images of a dataset folder that failed in an earlier run, and nothing else. If none failed, there is nothing to do.</source>
        <translation>Captura de nuevo las imágenes de una carpeta de conjunto de datos que una ejecución anterior anotó como fallidas, y nada más. Donde nada ha fallado no hay nada que hacer.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/capture.py"/>
        <source>Captures the images of a mission into a folder: georeferenced images, a table with the pose of each, the footprints, and a journal. Each tile is fetched once.</source>
        <translation>Captura en una carpeta las imágenes de una misión: imágenes georreferenciadas, una tabla con la pose de cada una, las huellas y un diario. Cada tesela se pide una vez.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/capture.py"/>
        <source>Configuration of QGIS's authentication database: a Basic one with the key as its password for sources that take a key, any other for the requests. Without one, that of the mission panel, or the environment's TERRAINAV_KEY.</source>
        <translation>Configuración de la base de datos de autenticación de QGIS: de autenticación básica, con la clave como contraseña, para fuentes que llevan clave; cualquier otra para las peticiones. Sin ella, la del panel de misión o la variable de entorno TERRAINAV_KEY.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/capture.py"/>
        <source>Georeferenced images with their poses, as a simulated UAV takes them.</source>
        <translation>Imágenes georreferenciadas con sus poses, como las toma un UAV simulado.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/capture.py"/>
        <source>Images are written completely or not at all; the log, the journal and the table give the reason for each that could not be fetched. Run it again into the same folder to resume an interrupted capture.</source>
        <translation>Una imagen está entera o no se escribe; lo que no se pudo obtener figura en el registro, el diario y la tabla con su motivo. Ejecutarlo de nuevo en la misma carpeta continúa una captura interrumpida.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/capture.py"/>
        <source>Images asked for</source>
        <translation>Imágenes pedidas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/capture.py"/>
        <source>Images that already existed</source>
        <translation>Imágenes que ya existían</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/capture.py"/>
        <source>Images written</source>
        <translation>Imágenes escritas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/capture.py"/>
        <source>Make a mosaic</source>
        <translation>Crear un mosaico</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/capture.py"/>
        <source>Mosaic of the first map type</source>
        <translation>Mosaico del primer tipo de mapa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/capture.py"/>
        <source>Of an earlier capture.</source>
        <translation>De una captura anterior.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/capture.py"/>
        <source>One raster for each map type, of the images that are there; turned and tilted ones are orthorectified.</source>
        <translation>Un ráster por tipo de mapa, con las imágenes que hay; las giradas e inclinadas se ortorrectifican.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/capture.py"/>
        <source>Only those that failed in an earlier capture.</source>
        <translation>Solo las que fallaron en una captura anterior.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/capture.py"/>
        <source>Stopped at {done} of {total} images. Enter {folder} as the folder, and run it again to go on.</source>
        <translation>Detenido en {done} de {total} imágenes. Introduzca {folder} como carpeta y ejecútelo de nuevo para continuar.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/capture.py"/>
        <source>The footprints and the mosaics, if the algorithm runs in a project.</source>
        <translation>Las huellas y los mosaicos, cuando el algoritmo se ejecuta en un proyecto.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/capture.py"/>
        <source>The mission comes from the parameters or from a mission file, among the advanced parameters.</source>
        <translation>La misión es la de los parámetros o, en los parámetros avanzados, la de un archivo escrito por el plan.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/capture.py"/>
        <source>Without a mosaic: {reason}</source>
        <translation>Sin mosaico: {reason}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/capture.py"/>
        <source>folder {folder}: holds no capture, as it has no {file}</source>
        <translation>carpeta {folder}: no contiene ninguna captura, pues no tiene {file}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/capture.py"/>
        <source>uav,drone,capture,failed,retry,resume,dataset</source>
        <translation>uav,drone,dron,captura,fallidas,reintentar,continuar,conjunto de datos,dataset</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/capture.py"/>
        <source>uav,drone,capture,images,dataset,tiles,download,georeferenced,photogrammetry,training</source>
        <translation>uav,drone,dron,captura,imágenes,conjunto de datos,dataset,teselas,descarga,georreferenciado,fotogrametría,entrenamiento</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/capture.py"/>
        <source>{count} images into {folder}.</source>
        <translation>{count} imágenes en {folder}.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/capture.py"/>
        <source>{count} more, named in the folder's journal and tables.</source>
        <translation>{count} más, indicadas en el diario y las tablas de la carpeta.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/capture.py"/>
        <source>{map_type}: the same tile came for {places} places and is in {images} images, such as {image}. It may be water or snow; if it shows no imagery, enter {digest} under “Tiles to treat as missing” and run it again.</source>
        <translation>{map_type}: la misma tesela llegó para {places} lugares y está en {images} imágenes, como {image}. Puede ser agua o nieve; si no muestra imágenes, introducir {digest} en «Teselas que tratar como ausentes» y ejecutarlo de nuevo.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/capture.py"/>
        <source>{written} images written, {skipped} already existed, {failed} failed, in {seconds} s.</source>
        <translation>{written} imágenes escritas, {skipped} ya existían, {failed} fallaron, en {seconds} s.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/choices.py"/>
        <source>{title} {value!r}: must be one of {choices}</source>
        <translation>{title} {value!r}: debe ser uno de {choices}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>A GeoTIFF with overviews.</source>
        <translation>Un GeoTIFF con vistas generales.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Action</source>
        <translation>Acción</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Camera frames become a COLMAP model, nerfstudio's transforms or a trajectory; the images stay where they are. Any dataset becomes tables of Parquet, folders for Hugging Face's datasets, a description of its files, or STAC items and their collection. A dataset with labels becomes a training set in the layout of COCO or YOLO, and a benchmark the layout of a published one.</source>
        <translation>Las vistas de cámara se convierten en un modelo de COLMAP, las transformaciones de nerfstudio o una trayectoria; las imágenes quedan donde están. Cualquier conjunto de datos se convierte en tablas de Parquet, carpetas para los datasets de Hugging Face, una descripción de sus archivos, o ítems STAC y su colección. Un conjunto de datos con etiquetas se convierte en un conjunto de entrenamiento con la estructura de COCO o YOLO, y un conjunto de evaluación toma la estructura de uno publicado.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Clean a dataset</source>
        <translation>Limpiar un conjunto de datos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Divides images into training, validation and test, and scales their positions.</source>
        <translation>Divide las imágenes en entrenamiento, validación y prueba, y escala sus posiciones.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Entropy of each image</source>
        <translation>Entropía de cada imagen</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Export a dataset or benchmark</source>
        <translation>Exportar un conjunto de datos o de evaluación</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Folder of the diagrams</source>
        <translation>Carpeta de los diagramas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Format</source>
        <translation>Formato</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Frame and scaler of the labels (JSON)</source>
        <translation>Sistema y escalador de las etiquetas (JSON)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Ground sample distance (metres)</source>
        <translation>Distancia de muestreo del terreno (metros)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Height (px)</source>
        <translation>Alto (px)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Histogram and bar plot of the entropies as PNG, for each map type; needs matplotlib.</source>
        <translation>Histograma y gráfico de barras de las entropías en PNG, para cada tipo de mapa; necesita matplotlib.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Histogram of the entropies</source>
        <translation>Histograma de las entropías</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>If empty, that of the images, or a larger one where the mosaic would have over 268 million pixels.</source>
        <translation>Si está vacío, la de las imágenes, o una mayor si el mosaico tuviera más de 268 millones de píxeles.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Images below it are rejected; 0 to 8.</source>
        <translation>Las imágenes por debajo se rechazan; 0 a 8.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Images in no part</source>
        <translation>Imágenes en ninguna parte</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Images in the mosaic</source>
        <translation>Imágenes en el mosaico</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Images moved</source>
        <translation>Imágenes movidas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Images rejected, or put back</source>
        <translation>Imágenes rechazadas o devueltas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Images that look straight down with north at the top keep their pixels. Failed and rejected images are left out. Ground that no image shows is transparent.</source>
        <translation>Las imágenes que miran recto hacia abajo con el norte arriba conservan sus propios píxeles. Las imágenes fallidas y las rechazadas quedan fuera. Lo que ninguna imagen muestra es transparente.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Images, files or queries written</source>
        <translation>Imágenes, archivos o consultas escritos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Make an orthomosaic</source>
        <translation>Crear un ortomosaico</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Mark rejected images in the table, move them as well, or put all back.</source>
        <translation>Marcar en la tabla las imágenes rechazadas, moverlas además, o devolverlo todo a su sitio.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Minimum entropy (bits)</source>
        <translation>Entropía mínima (bits)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Nothing is deleted. mark notes in the table's column “rejected” why an image is rejected; move also moves it, with the files that belong to it, to a folder “rejected” beside the others; undo puts all back. A later capture into the folder takes moved images into account.</source>
        <translation>No se borra nada. mark anota en la columna «rejected» de la tabla por qué se rechaza una imagen; move además la mueve, con sus archivos, a una carpeta «rejected» junto a las demás; undo lo devuelve todo a su sitio. Una captura posterior en la carpeta tiene en cuenta lo que se movió.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Of a capture, or of a benchmark.</source>
        <translation>De una captura o de un conjunto de evaluación.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Of a capture, or of images with a meta_data.csv beside them.</source>
        <translation>De una captura, o de imágenes con un meta_data.csv al lado.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Of a capture.</source>
        <translation>De una captura.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Of camera frames: {views}. Of any dataset: {datasets}. Of labels of pixels: {labels}. Of a sequence: {sequences}. Of a benchmark: {benchmarks}.</source>
        <translation>De vistas de cámara: {views}. De cualquier conjunto de datos: {datasets}. De etiquetas de píxeles: {labels}. De una secuencia: {sequences}. De un conjunto de evaluación: {benchmarks}.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>One orthophoto of all images of a dataset, also of turned and tilted ones and over relief.</source>
        <translation>Una sola ortofoto de todas las imágenes de un conjunto de datos, también de las giradas e inclinadas y sobre relieve.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Orthomosaic</source>
        <translation>Ortomosaico</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Rejects images whose entropy is below a threshold. If a place has a roadmap image, its entropy decides for all map types; otherwise each image's entropy does.</source>
        <translation>Rechaza las imágenes cuya entropía está por debajo de un umbral. Donde hay imágenes de callejero, las suyas deciden para todos los tipos de mapa; en los demás casos, la de la propia imagen.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Rejects low-detail images; deletes nothing.</source>
        <translation>Rechaza las imágenes con poco detalle; no borra nada.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Split a dataset</source>
        <translation>Dividir un conjunto de datos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Such as satellite; the dataset's first one if empty.</source>
        <translation>Por ejemplo satellite; si está vacío, el primero del conjunto de datos.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Suggested threshold (bits)</source>
        <translation>Umbral sugerido (bits)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Test images</source>
        <translation>Imágenes de prueba</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>The one to export, of several. If empty: satellite, or all for formats of datasets.</source>
        <translation>De varios, el que se exporta. Si está vacío: satellite, o todos en los formatos de conjuntos de datos.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>The suggested threshold separates the entropies by Otsu's method. If they form one group, nothing stands out, and the log says so.</source>
        <translation>El umbral sugerido separa las entropías por el método de Otsu. Si forman un solo grupo, nada destaca, y el registro lo dice.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>The table's entropies are not those of grey levels (the paper's equation 10), whose thresholds do not fit.</source>
        <translation>Las entropías de la tabla no son las de niveles de gris (ecuación 10 del artículo), cuyos umbrales no les corresponden.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Training images</source>
        <translation>Imágenes de entrenamiento</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Turned and tilted images are orthorectified by the exact camera, over level ground or the mission's relief. Each pixel comes from the image that sees its ground most nearly from straight above: at one height of flight, the one whose nadir is nearest. Ground that relief hides from an image is taken from another that sees it.</source>
        <translation>Las imágenes giradas e inclinadas se ortorrectifican con la cámara exacta, sobre terreno llano o sobre el relieve de la misión. Cada píxel viene de la imagen que ve su terreno más desde arriba: a una misma altura de vuelo, aquella cuyo nadir está más cerca. El terreno que el relieve oculta a una imagen se toma de otra que lo ve.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Undo has no threshold: no diagrams are drawn.</source>
        <translation>Deshacer no tiene umbral: no se dibujan diagramas.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Validation images</source>
        <translation>Imágenes de validación</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Width (px)</source>
        <translation>Ancho (px)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Writes a dataset or a benchmark in a format of other programs.</source>
        <translation>Escribe un conjunto de datos o de evaluación en un formato de otros programas.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>Writes the part of each image to the column “split” of the tables: train, validation or test. Images of one place are in the same part in all map types; failed and rejected ones are in none.</source>
        <translation>Escribe la parte de cada imagen en la columna «split» de las tablas: train, validation o test. Las imágenes de un mismo lugar están en la misma parte en todos los tipos de mapa; las fallidas y las rechazadas no están en ninguna.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>dataset,clean,entropy,filter,reject,training,machine learning</source>
        <translation>conjunto de datos,dataset,limpiar,entropía,filtro,rechazar,entrenamiento,aprendizaje automático</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>dataset,export,colmap,nerfstudio,parquet,hugging face,croissant,stac,coco,yolo,benchmark,university-1652</source>
        <translation>conjunto de datos,exportar,colmap,nerfstudio,parquet,hugging face,croissant,stac,coco,yolo,evaluación,university-1652</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>dataset,mosaic,orthophoto,orthomosaic,orthorectify,nadir,tilted,oblique,relief</source>
        <translation>conjunto de datos,mosaico,ortofoto,ortomosaico,ortorrectificar,nadir,inclinada,oblicua,relieve</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>dataset,split,training,validation,test,blocks,labels,machine learning</source>
        <translation>conjunto de datos,dividir,entrenamiento,validación,prueba,bloques,etiquetas,aprendizaje automático</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>labels.json has the frame and the scaler of the images' positions, fitted on the training part: utm is the zone of the middle, mission a plane about the middle.</source>
        <translation>labels.json contiene el sistema y el escalador de las posiciones de las imágenes, ajustado con la parte de entrenamiento: utm es la zona del centro, mission un plano en torno al centro.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>mosaic {path}: must be a GeoTIFF (.tif)</source>
        <translation>mosaico {path}: debe ser un GeoTIFF (.tif)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>shuffled follows a hash of the seed and the image's name, the same on every computer; in-order follows the table; blocks divides the ground, so that none is in images of two parts: images in between are marked “gap”, as are those that see the horizon. auto takes blocks where images overlap, and shuffles otherwise.</source>
        <translation>shuffled sigue un hash de la semilla y del nombre de la imagen, el mismo en cualquier ordenador; in-order sigue la tabla; blocks divide el terreno, de modo que ninguno está en imágenes de dos partes: las imágenes intermedias se marcan «gap», igual que las que ven el horizonte. auto toma blocks donde las imágenes se solapan, y si no shuffled.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>{map_type}: the entropies form one group: nothing stands out, and the suggested threshold cuts through its middle.</source>
        <translation>{map_type}: las entropías forman un solo grupo: nada destaca, y el umbral sugerido lo corta por la mitad.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>{map_type}: the threshold rejects {rejected} of {images} images.</source>
        <translation>{map_type}: el umbral rechaza {rejected} de {images} imágenes.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>{map_type}: {rejected} of {images} images, {moved} moved, {returned} moved back.</source>
        <translation>{map_type}: {rejected} de {images} imágenes, {moved} movidas, {returned} devueltas.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>{map_type}: {used} of {images} images, {width} × {height} px of {gsd} m.</source>
        <translation>{map_type}: {used} de {images} imágenes, {width} × {height} px de {gsd} m.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/datasets.py"/>
        <source>{names}: does not yet reflect the moved images; to update it, run “Make an orthomosaic”, or choose “Open dataset folder” in the panel's Missions menu.</source>
        <translation>{names}: sigue como antes de mover imágenes; «Crear un ortomosaico», o «Abrir carpeta de conjunto de datos» en las misiones del panel, lo crea de nuevo.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/imagery.py"/>
        <source>I agree to the source's terms</source>
        <translation>Acepto las condiciones de la fuente</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/imagery.py"/>
        <source>Key or authentication</source>
        <translation>Clave o autenticación</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/imagery.py"/>
        <source>SHA-256 of tiles that show no imagery, with spaces between them; the log names tiles received for many places. Images that show one are captured again. The tiles in TerrAInav's options count as well.</source>
        <translation>SHA-256 de las teselas que no muestran imágenes, separados por espacios; el registro nombra las teselas que llegaron para muchos lugares. Las imágenes que muestran una se capturan de nuevo. También cuentan las de las opciones de TerrAInav.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/imagery.py"/>
        <source>Sources that ask for consent refuse larger missions without it.</source>
        <translation>Las fuentes que piden conformidad rechazan sin ella las misiones mayores.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/imagery.py"/>
        <source>Tiles to treat as missing</source>
        <translation>Teselas que tratar como ausentes</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/line.py"/>
        <source>Flies lines at a speed, one after another, and gives points at intervals of time or distance. Corners become turns whose radius follows from speed and bank angle; between short legs they are tighter and slower.</source>
        <translation>Vuela líneas a una velocidad, una tras otra, y da puntos a intervalos de tiempo o de distancia. Los vértices se convierten en virajes cuyo radio resulta de la velocidad y de la inclinación lateral; entre tramos cortos son más cerrados y se vuelan más despacio.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/line.py"/>
        <source>Lines</source>
        <translation>Líneas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/line.py"/>
        <source>Lines in any CRS; the first exposure is at the beginning of each.</source>
        <translation>Líneas en cualquier SRC; la primera exposición está al principio de cada una.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/line.py"/>
        <source>Points along lines that are flown at a speed, with height, yaw, roll and time.</source>
        <translation>Puntos a lo largo de líneas voladas a una velocidad, con altura, guiñada, alabeo y hora.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/line.py"/>
        <source>Poses</source>
        <translation>Poses</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/line.py"/>
        <source>Poses along a line</source>
        <translation>Poses a lo largo de una línea</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/line.py"/>
        <source>The points are an area for the other algorithms: choose their fields there for height, yaw, roll and time.</source>
        <translation>Los puntos sirven de área a los demás algoritmos: elija allí sus campos como los de alturas, guiñadas, alabeos y horas.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/line.py"/>
        <source>uav,drone,line,trajectory,flight,speed,turn,bank,yaw,points,poses</source>
        <translation>uav,drone,dron,línea,trayectoria,vuelo,velocidad,viraje,inclinación lateral,guiñada,puntos,poses</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/mission_parameters.py"/>
        <source>A mission file written by “Plan a mission”. All parameters above are then ignored.</source>
        <translation>Una misión tal como la escribe el plan; los parámetros anteriores no se tienen en cuenta.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/mission_parameters.py"/>
        <source>Area: coordinates</source>
        <translation>Área: coordenadas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/mission_parameters.py"/>
        <source>Area: extent</source>
        <translation>Área: extensión</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/mission_parameters.py"/>
        <source>Area: polygons or points</source>
        <translation>Área: polígonos o puntos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/mission_parameters.py"/>
        <source>Aspect ratio, width:height</source>
        <translation>Relación de aspecto, anchura:altura</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/mission_parameters.py"/>
        <source>Box to cover. Give this, a layer, coordinates, or a mission file.</source>
        <translation>Recuadro que se ha de cubrir. Dar esto, una capa, coordenadas o un archivo de misión.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/mission_parameters.py"/>
        <source>By title or name, as “Synthetic (offline)” or “world”, which is the embedded landscape and needs no network.</source>
        <translation>Por título o nombre, como «Synthetic (offline)» o «world», que es el paisaje incorporado y no necesita red.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/mission_parameters.py"/>
        <source>Capture time field</source>
        <translation>Campo de hora de captura</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/mission_parameters.py"/>
        <source>Gimbal pitch field</source>
        <translation>Campo de cabeceo del cardán</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/mission_parameters.py"/>
        <source>Height above ground of each point, metres.</source>
        <translation>Altura de cada punto sobre el terreno, en metros.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/mission_parameters.py"/>
        <source>Height field</source>
        <translation>Campo de altura</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/mission_parameters.py"/>
        <source>Mission file</source>
        <translation>Archivo de misión</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/mission_parameters.py"/>
        <source>Other source</source>
        <translation>Otra fuente</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/mission_parameters.py"/>
        <source>Pitch of each point instead of a tilt, degrees: -90 looks straight down.</source>
        <translation>Cabeceo de cada punto en lugar de una inclinación, en grados: -90 mira en vertical hacia abajo.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/mission_parameters.py"/>
        <source>Polygons (with holes) to cover, each with separate rows; those that touch are merged. Or points, each one capture. In any CRS.</source>
        <translation>Polígonos (con huecos) que se cubren, cada uno con sus propias pasadas; los que se tocan son uno solo. O puntos, cada uno de los cuales es una captura. En cualquier SRC.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/mission_parameters.py"/>
        <source>Polygons over which no image is taken: images planned inside are left out.</source>
        <translation>Polígonos donde no puede haber ninguna cámara: las imágenes planificadas dentro se omiten.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/mission_parameters.py"/>
        <source>Roll field</source>
        <translation>Campo de alabeo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/mission_parameters.py"/>
        <source>Roll of each point, degrees, right side down.</source>
        <translation>Alabeo de cada punto, en grados, positivo con el lado derecho hacia abajo.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/mission_parameters.py"/>
        <source>Sets the field of view, aspect ratio and pixels. If no camera is chosen, the values below apply.</source>
        <translation>Su campo de visión, relación de aspecto y píxeles. Sin ella cuentan los de abajo.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/mission_parameters.py"/>
        <source>Source of imagery</source>
        <translation>Fuente de las imágenes</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/mission_parameters.py"/>
        <source>Tilt field</source>
        <translation>Campo de inclinación</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/mission_parameters.py"/>
        <source>Tilt of each point, degrees: 0 looks straight down.</source>
        <translation>Inclinación de cada punto, en grados: 0 mira en vertical hacia abajo.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/mission_parameters.py"/>
        <source>Time of each point: a date with its time, text such as 2024-06-21T10:30:00Z, or seconds after 1970; in UTC where no zone is stated. Captures are in the order of their times.</source>
        <translation>Hora de cada punto: una fecha con su hora, texto como 2024-06-21T10:30:00Z, o segundos desde 1970; en UTC donde no se indica la zona. Las capturas siguen el orden de sus horas.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/mission_parameters.py"/>
        <source>Used instead of the source above: one of your own sources by name or title, a URL template with {z}, {x}, {y}, wmts:URL#layer=NAME, wms:URL#layers=NAME, arcgis:URL, ogcapi:URL#collection=NAME, a raster or MBTiles file, or qgis:project for the project's map.</source>
        <translation>Se usa en lugar de la fuente anterior: una fuente propia por nombre o título, una plantilla de URL con {z}, {x}, {y}, wmts:URL#layer=NOMBRE, wms:URL#layers=NOMBRE, arcgis:URL, ogcapi:URL#collection=NOMBRE, un archivo ráster o MBTiles, o qgis:project para el mapa del proyecto.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/mission_parameters.py"/>
        <source>Without a chosen camera; such as 4:3, 16:9 or 1.5.</source>
        <translation>Donde no se elige ninguna cámara; como 4:3, 16:9 o 1.5.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/mission_parameters.py"/>
        <source>Yaw field</source>
        <translation>Campo de guiñada</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/mission_parameters.py"/>
        <source>Yaw of each point, degrees clockwise from north.</source>
        <translation>Guiñada de cada punto, en grados en sentido horario desde el norte.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/mission_parameters.py"/>
        <source>aspect ratio {text!r}: must be such as 4:3</source>
        <translation>relación de aspecto {text!r}: debe ser como 4:3</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/mission_parameters.py"/>
        <source>image size {text!r}: must be width height channels, such as 256 256 3</source>
        <translation>tamaño de imagen {text!r}: debe ser anchura altura canales, como 256 256 3</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/mission_parameters.py"/>
        <source>lat_lon_agl for one capture, latTL_lonTL_latBR_lonBR_agl for a box, with or without the height, or a file: lat lon agl [yaw] lines, or a table whose first line names its columns; heights in metres.</source>
        <translation>lat_lon_agl para una captura, latTL_lonTL_latBR_lonBR_agl para un recuadro, con la altura o sin ella, o un archivo: líneas de lat lon agl [guiñada], o una tabla cuya primera línea nombra las columnas; alturas en metros.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/mission_parameters.py"/>
        <source>{count} areas given: needs one of extent, polygons or points, and coordinates</source>
        <translation>hay {count} áreas dadas: se necesita una sola de entre extensión, polígonos o puntos, y coordenadas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/mission_parameters.py"/>
        <source>{help} If empty, as the chosen camera has it.</source>
        <translation>{help} Si se deja vacío, como lo tiene la cámara elegida.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/mission_parameters.py"/>
        <source>{help} Without a chosen camera.</source>
        <translation>{help} Donde no se elige ninguna cámara.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>Align rows</source>
        <translation>Alinear filas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>All files (*.*)</source>
        <translation>Todos los archivos (*.*)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>Captures</source>
        <translation>Capturas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>Coverage (percent)</source>
        <translation>Cobertura (porcentaje)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>Download (bytes)</source>
        <translation>Descarga (bytes)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>Error bound (px)</source>
        <translation>Cota del error (px)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>Files (bytes)</source>
        <translation>Archivos (bytes)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>Flight distance (metres)</source>
        <translation>Distancia de vuelo (metros)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>Flight path with take-off and turns (metres)</source>
        <translation>Trayectoria de vuelo con despegue y giros (metros)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>Flight time (seconds)</source>
        <translation>Tiempo de vuelo (segundos)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>Footprints are those of the images that a capture of the same mission writes. Coverage and overlap are counted on the pixels that the files will show; the error bound is that of the methods chosen.</source>
        <translation>Las huellas son las de las imágenes que escribe una captura de la misma misión. La cobertura y el solape se cuentan sobre los píxeles que mostrarán los archivos; la cota del error es la de los métodos elegidos.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>Footprints, coverage and figures of a simulated UAV flight; fetches nothing.</source>
        <translation>Huellas, cobertura y cifras de un vuelo UAV simulado; no pide nada a la red.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>Further missions of the plan's file</source>
        <translation>Otras misiones del archivo del plan</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>Give the area as an extent, as a layer of polygons or of points, or as coordinates.</source>
        <translation>Dar el área como extensión, como capa de polígonos o de puntos, o como coordenadas.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>Ground sample distance delivered (metres)</source>
        <translation>Distancia de muestreo del terreno entregada (metros)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>Ground sample distance requested (metres)</source>
        <translation>Distancia de muestreo del terreno pedida (metros)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>Images of one map type</source>
        <translation>Imágenes de un tipo de mapa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>Minimum front overlap (percent)</source>
        <translation>Solape longitudinal mínimo (porcentaje)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>Minimum side overlap (percent)</source>
        <translation>Solape transversal mínimo (porcentaje)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>Mission as a file</source>
        <translation>Misión como archivo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>Mission files that one flight serves after this mission, in their order, with safe transits between them. Layers and numbers are of this mission alone.</source>
        <translation>Archivos de misión que un mismo vuelo atiende después de esta misión, en su orden, con tránsitos seguros entre ellas. Las capas y los números son solo de esta misión.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>Plan a mission</source>
        <translation>Planificar una misión</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>Plan as a file</source>
        <translation>Plan como archivo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>Plans a mission without fetching imagery: the position, ground and time of each image, and the time and data that the capture needs.</source>
        <translation>Calcula una misión sin pedir imágenes: dónde se toma cada imagen, qué terreno muestra, en qué momento del vuelo, y qué exige el conjunto.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>Sorties</source>
        <translation>Salidas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>The layer cannot be written: {reason}</source>
        <translation>No se puede escribir la capa: {reason}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>Tiles of one map type</source>
        <translation>Teselas de un tipo de mapa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>Time of the capture (seconds)</source>
        <translation>Tiempo de la captura (segundos)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>Time of the flight path (seconds)</source>
        <translation>Tiempo de la trayectoria de vuelo (segundos)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>Turns the rows along the longest side of the area or for the shortest flight, instead of by the row azimuth; the mission file has the azimuth found.</source>
        <translation>Orienta las filas según el lado más largo del área, o de modo que el vuelo sea el más corto, en lugar del acimut de las filas; el archivo de misión tiene el acimut hallado.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>Written: {file}</source>
        <translation>Escrito: {file}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>Zoom of the plan</source>
        <translation>Zoom del plan</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>further missions: need the plan as a file</source>
        <translation>otras misiones: requieren el plan como archivo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/plan.py"/>
        <source>uav,drone,mission,plan,footprint,flight,overlap,coverage,photogrammetry,waypoints</source>
        <translation>uav,drone,dron,misión,plan,huella,vuelo,solape,cobertura,fotogrametría,puntos de ruta</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/report.py"/>
        <source>Accuracy report of a mission</source>
        <translation>Informe de exactitud de una misión</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/report.py"/>
        <source>As for a capture.</source>
        <translation>Como para una captura.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/report.py"/>
        <source>Files of an earlier report are replaced.</source>
        <translation>Los archivos de un informe anterior se sustituyen.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/report.py"/>
        <source>Folder of the report</source>
        <translation>Carpeta del informe</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/report.py"/>
        <source>In wind, it also reports how far the wind moves and turns the camera, and how that affects coverage and overlap.</source>
        <translation>Con viento dice además cuánto desplaza y gira el viento la cámara, y cómo cambian con ello la cobertura y el solape.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/report.py"/>
        <source>Measures every method's error against its run time.</source>
        <translation>Mide el error de cada método frente a su tiempo de ejecución.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/report.py"/>
        <source>Measures the methods of footprints and images on captures of the mission itself, against an exact reference: error, bound and time of each, what was chosen, and what was left out. Writes a page with diagrams, and the numbers as tables.</source>
        <translation>Mide los métodos de huellas e imágenes en capturas de la propia misión frente a una referencia exacta: error, cota y tiempo de cada uno, qué se eligió y qué se omitió. Escribe una página con diagramas, y los números como tablas.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/report.py"/>
        <source>Measuring: {what}</source>
        <translation>Midiendo: {what}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/report.py"/>
        <source>Quick</source>
        <translation>Rápido</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/report.py"/>
        <source>Report</source>
        <translation>Informe</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/report.py"/>
        <source>Time every method once only; the times are then not compared.</source>
        <translation>Medir el tiempo de cada método una sola vez; los tiempos no se comparan entonces.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/report.py"/>
        <source>accuracy,error,bound,run time,report,footprint,reprojection</source>
        <translation>exactitud,error,cota,tiempo de ejecución,informe,huella,reproyección</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/report.py"/>
        <source>the report is not finished</source>
        <translation>el informe no está terminado</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/windows.py"/>
        <source>Benchmarks need QGIS's own plugin Processing and its provider TerrAInav; one is not enabled.</source>
        <translation>Los bancos de pruebas necesitan el complemento Processing del propio QGIS y su proveedor TerrAInav; uno de ellos no está activado.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/windows.py"/>
        <source>Score</source>
        <translation>Puntuar</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/processing/windows.py"/>
        <source>{name}: {queries} queries, and {tiles} tiles of the reference.</source>
        <translation>{name}: {queries} consultas y {tiles} teselas de la referencia.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/profile/chart.py"/>
        <source>A click shows the place on the map, the wheel zooms, dragging pans, and a double click shows the whole flight.
Arrow keys move the cursor, Page keys from image to image, Enter shows the place, + and - zoom, Esc shows the whole flight.</source>
        <translation>Un clic muestra el lugar en el mapa, la rueda cambia el zoom, arrastrar desplaza y un doble clic muestra todo el vuelo.
Las flechas mueven el cursor; AvPág y RePág, de imagen en imagen; Intro muestra el lugar; + y - cambian el zoom; Esc muestra todo el vuelo.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/profile/chart.py"/>
        <source>Distance flown ({unit})</source>
        <translation>Distancia volada ({unit})</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/profile/chart.py"/>
        <source>Height ({unit})</source>
        <translation>Altura ({unit})</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/profile/chart.py"/>
        <source>Height profile</source>
        <translation>Perfil de alturas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/profile/dock.py"/>
        <source>&amp;Least clearance</source>
        <translation>Distancia &amp;libre mínima</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/profile/dock.py"/>
        <source>&amp;Save as table or image…</source>
        <translation>&amp;Guardar como tabla o imagen…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/profile/dock.py"/>
        <source>&amp;Whole flight</source>
        <translation>&amp;Todo el vuelo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/profile/dock.py"/>
        <source>Clearance {height}</source>
        <translation>Distancia libre {height}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/profile/dock.py"/>
        <source>Ground</source>
        <translation>Terreno</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/profile/dock.py"/>
        <source>Least clearance {height} at {distance}</source>
        <translation>Distancia libre mínima {height} a {distance}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/profile/dock.py"/>
        <source>Level ground: the mission has no relief</source>
        <translation>Terreno llano: la misión no tiene relieve</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/profile/dock.py"/>
        <source>Surface</source>
        <translation>Superficie</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/profile/dock.py"/>
        <source>TerrAInav: height profile</source>
        <translation>TerrAInav: perfil de alturas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/profile/dock.py"/>
        <source>Working out the height profile…</source>
        <translation>Calculando el perfil de alturas…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/profile/dock.py"/>
        <source>after image {number}</source>
        <translation>tras la imagen {number}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/profile/dock.py"/>
        <source>image {number}</source>
        <translation>imagen {number}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/profile/dock.py"/>
        <source>landing</source>
        <translation>aterrizaje</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/profile/dock.py"/>
        <source>sortie {number}</source>
        <translation>salida {number}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/profile/dock.py"/>
        <source>take-off</source>
        <translation>despegue</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/profile/dock.py"/>
        <source>unknown</source>
        <translation>desconocida</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/profile/profiles.py"/>
        <source>Height profile saved as {name}.</source>
        <translation>Perfil de alturas guardado como {name}.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/profile/profiles.py"/>
        <source>Image (*.png)</source>
        <translation>Imagen (*.png)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/profile/profiles.py"/>
        <source>Table (*.csv)</source>
        <translation>Tabla (*.csv)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/profile/profiles.py"/>
        <source>TerrAInav: save height profile</source>
        <translation>TerrAInav: guardar el perfil de alturas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/profile/profiles.py"/>
        <source>This place cannot be shown in the map's CRS.</source>
        <translation>Este lugar no se puede mostrar en el SRC del mapa.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/qgis_source/connections.py"/>
        <source>QGIS connection “{name}” holds a user name and password in plain text: give it an authentication configuration in QGIS's Browser panel</source>
        <translation>La conexión de QGIS «{name}» contiene usuario y contraseña en texto sin cifrar: dele una configuración de autenticación en el panel Navegador de QGIS</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/qgis_source/connections.py"/>
        <source>QGIS connection “{name}” holds keys in its address ({keys}), which would end up in files: take them out of it, and give it an authentication configuration in QGIS's Browser panel</source>
        <translation>La conexión de QGIS «{name}» contiene claves en su dirección ({keys}), que acabarían en archivos: quítelas de ella y dele una configuración de autenticación en el panel Navegador de QGIS</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/qgis_source/connections.py"/>
        <source>QGIS connection “{name}”: {problem}</source>
        <translation>Conexión de QGIS «{name}»: {problem}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/qgis_source/connections.py"/>
        <source>source {name}: QGIS has no such XYZ connection (any more); choose another source</source>
        <translation>fuente {name}: QGIS no tiene (o ya no tiene) tal conexión XYZ; elija otra fuente</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/qgis_source/snapshot.py"/>
        <source>Whole map</source>
        <translation>Mapa completo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/qgis_source/snapshot.py"/>
        <source>layer {name}: its pixels have no size</source>
        <translation>capa {name}: sus píxeles no tienen tamaño</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/qgis_source/snapshot.py"/>
        <source>layer {name}: its place on the globe is not known; set its CRS</source>
        <translation>capa {name}: no se conoce su lugar en el globo; defina su SRC</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/qgis_source/snapshot.py"/>
        <source>layer {name}: shows nothing; repair its data source</source>
        <translation>capa {name}: no muestra nada; repare su fuente de datos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/qgis_source/snapshot.py"/>
        <source>source {name}: the project has no such layer (any more); choose another source</source>
        <translation>fuente {name}: el proyecto no tiene (o ya no tiene) tal capa; elija otra fuente</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/qgis_source/snapshot.py"/>
        <source>the map shows no layer: tick one in the Layers panel</source>
        <translation>el mapa no muestra ninguna capa: marque una en el panel Capas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/qgis_source/tiles.py"/>
        <source>layer {name}: its service has tiles of {size} px; choose a layer with tiles of 256, 512 or 1024 px</source>
        <translation>capa {name}: su servicio tiene teselas de {size} px; elija una capa con teselas de 256, 512 o 1024 px</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/remote/address.py"/>
        <source>address {address}: must begin with https://, http:// or s3://</source>
        <translation>dirección {address}: debe empezar por https://, http:// o s3://</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/remote/address.py"/>
        <source>address {address}: names no server or bucket</source>
        <translation>dirección {address}: no indica ningún servidor ni «bucket»</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/remote/address.py"/>
        <source>address: contains ? or #; must be that of the dataset's folder alone</source>
        <translation>dirección: contiene ? o #; debe ser solo la de la carpeta del conjunto de datos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/remote/address.py"/>
        <source>address: contains a user name or password, which belong in QGIS's authentication</source>
        <translation>dirección: contiene un nombre de usuario o una contraseña; que corresponden a la autenticación de QGIS</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/remote/address.py"/>
        <source>address: is missing; it must be such as https://host/run or s3://bucket/run</source>
        <translation>dirección: falta; debe ser como https://host/run o s3://bucket/run</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/remote/address.py"/>
        <source>address: must be of {most} printable characters at most</source>
        <translation>dirección: debe tener como máximo {most} caracteres imprimibles</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/remote/copies.py"/>
        <source>{address}: has no {name}</source>
        <translation>{address}: no tiene {name}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/remote/copies.py"/>
        <source>{address}: has no {name}: it is not a dataset of a capture, or does not exist</source>
        <translation>{address}: no tiene {name}, de modo que no es el conjunto de datos de una captura, o no existe</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/remote/copies.py"/>
        <source>{name} has its images in shards and is read-only</source>
        <translation>{name} tiene sus imágenes en fragmentos y solo se puede ver</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/remote/copies.py"/>
        <source>{name} is remote and read-only: {address}</source>
        <translation>{name} está en una dirección y solo se puede ver: {address}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/remote/geoparquet.py"/>
        <source>it does not list images of a capture</source>
        <translation>no enumera imágenes de una captura</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/remote/geoparquet.py"/>
        <source>it has no footprints</source>
        <translation>no tiene huellas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/remote/geoparquet.py"/>
        <source>table {path}: cannot be read ({reason})</source>
        <translation>tabla {path}: no se puede leer ({reason})</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/remote/images.py"/>
        <source>There is no image (yet) at {address}</source>
        <translation>(Todavía) no hay ninguna imagen en {address}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/remote/images.py"/>
        <source>image {name}: has more than {most} bytes</source>
        <translation>imagen {name}: tiene más de {most} bytes</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/remote/images.py"/>
        <source>image {name}: its row of the table names no part of a shard</source>
        <translation>imagen {name}: su fila de la tabla no indica ninguna parte de un fragmento</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/remote/images.py"/>
        <source>shard {shard}: cannot be read ({reason})</source>
        <translation>fragmento {shard}: no se puede leer ({reason})</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/remote/images.py"/>
        <source>shard {shard}: holds no image where the table says; it is torn, or another one</source>
        <translation>fragmento {shard}: no contiene ninguna imagen donde dice la tabla; está dañado o es otro</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/remote/images.py"/>
        <source>shard {shard}: is not there</source>
        <translation>fragmento {shard}: no existe</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/remote/images.py"/>
        <source>shard {shard}: is torn, it ends before the image does</source>
        <translation>fragmento {shard}: está dañado, acaba antes que la imagen</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/remote/images.py"/>
        <source>{shard}, bytes {first} to {last}</source>
        <translation>{shard}, bytes {first} a {last}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/remote/store.py"/>
        <source>fetching: stopped</source>
        <translation>obtención: detenida</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/compare.py"/>
        <source> s</source>
        <translation> s</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/compare.py"/>
        <source>&amp;Close</source>
        <translation>&amp;Cerrar</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/compare.py"/>
        <source>&amp;Flicker</source>
        <translation>&amp;Parpadeo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/compare.py"/>
        <source>&amp;every</source>
        <translation>ca&amp;da</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/compare.py"/>
        <source>An image layer of a mission or dataset on the map</source>
        <translation>Una capa de imagen de una misión o un conjunto de datos en el mapa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/compare.py"/>
        <source>Both are the same image.</source>
        <translation>Ambas son la misma imagen.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/compare.py"/>
        <source>Compare images (TerrAInav)</source>
        <translation>Comparar imágenes (TerrAInav)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/compare.py"/>
        <source>F&amp;irst image</source>
        <translation>P&amp;rimera imagen</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/compare.py"/>
        <source>S&amp;witch</source>
        <translation>Cam&amp;biar</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/compare.py"/>
        <source>Seco&amp;nd image</source>
        <translation>Se&amp;gunda imagen</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/compare.py"/>
        <source>Show the map as it was before</source>
        <translation>Mostrar el mapa como estaba antes</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/compare.py"/>
        <source>Show the other image (space bar)</source>
        <translation>Mostrar la otra imagen (barra espaciadora)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/compare.py"/>
        <source>Shown: {image}</source>
        <translation>Se muestra: {image}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/compare.py"/>
        <source>Switch again and again</source>
        <translation>Cambiar una y otra vez</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/compare.py"/>
        <source>There are no two images on the map: open two datasets by “Missions”.</source>
        <translation>No hay dos imágenes en el mapa: abra dos conjuntos de datos con «Misiones».</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/compare.py"/>
        <source>Time that each image is shown</source>
        <translation>Tiempo que se muestra cada imagen</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/labels_pane.py"/>
        <source>Background here</source>
        <translation>Aquí, fondo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/labels_pane.py"/>
        <source>Classes</source>
        <translation>Clases</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/labels_pane.py"/>
        <source>Instances</source>
        <translation>Instancias</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/labels_pane.py"/>
        <source>Labels drawn over the image</source>
        <translation>Etiquetas dibujadas sobre la imagen</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/labels_pane.py"/>
        <source>No labels</source>
        <translation>Sin etiquetas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/labels_pane.py"/>
        <source>Opacity of the labels</source>
        <translation>Opacidad de las etiquetas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/labels_pane.py"/>
        <source>Point at the image to see its labels</source>
        <translation>Señale la imagen para ver sus etiquetas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/labels_pane.py"/>
        <source>and {count} more classes</source>
        <translation>y {count} clases más</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/labels_pane.py"/>
        <source>{count} instances in this image</source>
        <translation>{count} instancias en esta imagen</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/labels_pane.py"/>
        <source>{name} {share} %</source>
        <translation>{name} {share} %</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/shots.py"/>
        <source>footprints {path}: have no poses</source>
        <translation>huellas {path}: no tienen poses</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/shots.py"/>
        <source>footprints {path}: {name} is not the name of an image</source>
        <translation>huellas {path}: {name} no es un nombre de imagen</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>&amp;Zoom to</source>
        <translation>&amp;Zoom a</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>Capture time</source>
        <translation>Hora de captura</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>Column, row</source>
        <translation>Columna, fila</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>Depth along the camera's axis; grey where no ground is seen</source>
        <translation>Profundidad a lo largo del eje de la cámara; gris donde no se ve suelo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>Depth here: {metres}</source>
        <translation>Profundidad aquí: {metres}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>Depth, grey where no ground is seen</source>
        <translation>Profundidad; gris donde no se ve suelo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>Entropy</source>
        <translation>Entropía</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>Failed</source>
        <translation>Fallida</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>Fetching {name}…</source>
        <translation>Obteniendo {name}…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>File</source>
        <translation>Archivo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>Height</source>
        <translation>Altura</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>Imagery date</source>
        <translation>Fecha de las imágenes</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>Images (TerrAInav)</source>
        <translation>Imágenes (TerrAInav)</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>Images that show the clicked place</source>
        <translation>Imágenes que muestran el lugar pulsado</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>Lay this image on the map, orthorectified where it is turned or tilted; press again to remove it</source>
        <translation>Poner esta imagen en el mapa, ortorrectificada si está girada o inclinada; pulse otra vez para quitarla</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>Map type shown</source>
        <translation>Tipo de mapa mostrado</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>Missing</source>
        <translation>Falta</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>Ne&amp;xt</source>
        <translation>&amp;Siguiente</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>Next image of the flight</source>
        <translation>Imagen siguiente del vuelo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>No ground here</source>
        <translation>Aquí no hay suelo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>Ope&amp;n</source>
        <translation>&amp;Abrir</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>Open the image in its default program</source>
        <translation>Abrir la imagen con su programa predeterminado</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>Position</source>
        <translation>Posición</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>Prev&amp;ious</source>
        <translation>A&amp;nterior</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>Previous image of the flight</source>
        <translation>Imagen anterior del vuelo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>Show on m&amp;ap</source>
        <translation>Mos&amp;trar en el mapa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>Show the image's footprint on the map</source>
        <translation>Mostrar en el mapa la huella de la imagen</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>Steep faces</source>
        <translation>Caras empinadas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>Yaw, tilt, roll</source>
        <translation>Guiñada, inclinación, alabeo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>by cleaning the dataset</source>
        <translation>al limpiar el conjunto de datos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>{agl} m above ground</source>
        <translation>{agl} m sobre el terreno</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>{agl} m above ground, {height} m above the ellipsoid</source>
        <translation>{agl} m sobre el terreno, {height} m sobre el elipsoide</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>{lat}°, {lon}°</source>
        <translation>{lat}°, {lon}°</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>{metres} m</source>
        <translation>{metres} m</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>{number} of {count}</source>
        <translation>{number} de {count}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>{number} of {count} here: {name}</source>
        <translation>{number} de {count} aquí: {name}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>{share} % of the pixels</source>
        <translation>{share} % de los píxeles</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>{width} × {height} of {crs}</source>
        <translation>{width} × {height} de {crs}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewer.py"/>
        <source>{}°, {}°, {}°</source>
        <translation>{}°, {}°, {}°</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewing.py"/>
        <source>Click a captured footprint on the map.</source>
        <translation>Pulsar una huella capturada en el mapa.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewing.py"/>
        <source>Looking for images…</source>
        <translation>Buscando imágenes…</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewing.py"/>
        <source>No image shows this place</source>
        <translation>Ninguna imagen muestra este lugar</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewing.py"/>
        <source>There are no captured images on the map yet: capture a mission, or open a dataset by “Missions”.</source>
        <translation>Aún no hay imágenes capturadas en el mapa: capture una misión, o abra un conjunto de datos con «Misiones».</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/results/viewing.py"/>
        <source>its heights are those of {place}, which you have not used in this QGIS: open its dataset by “Missions” and allow it</source>
        <translation>sus alturas son las de {place}, que no se ha usado en este QGIS: abra su conjunto de datos con «Misiones» y permítalo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/session.py"/>
        <source>Draw a box</source>
        <translation>Dibujar un recuadro</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/session.py"/>
        <source>No benchmark yet.</source>
        <translation>Aún no hay banco de pruebas.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/session.py"/>
        <source>No preview yet.</source>
        <translation>Aún no hay vista previa.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/session.py"/>
        <source>The map is empty: {link}, or add layers of your own.</source>
        <translation>El mapa está vacío: {link}, o añada capas propias.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/session.py"/>
        <source>The preview could not be drawn: {error}</source>
        <translation>No se ha podido dibujar la vista previa: {error}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/session.py"/>
        <source>show the selected imagery</source>
        <translation>mostrar las imágenes seleccionadas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/session.py"/>
        <source>show the selected imagery and draw a box</source>
        <translation>mostrar las imágenes seleccionadas y dibujar un recuadro</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/session.py"/>
        <source>{link} and drag over the area, or paste its coordinates in the tab Area.</source>
        <translation>{link} y arrastre sobre el área, o pegue sus coordenadas en la pestaña Área.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/session.py"/>
        <source>“{preset}” has set: {values}.</source>
        <translation>«{preset}» ha fijado: {values}.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/session.py"/>
        <source>“{preset}”: its values were there already.</source>
        <translation>«{preset}»: sus valores ya estaban.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/sources.py"/>
        <source>Sources that allow it: {names}.</source>
        <translation>Fuentes que lo permiten: {names}.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/sources.py"/>
        <source>its source has no imagery of the area</source>
        <translation>su fuente no tiene imágenes del área</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/sources.py"/>
        <source>this map of QGIS</source>
        <translation>este mapa de QGIS</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/sources.py"/>
        <source>{host} needs a key, which would be written into the project file: show another source</source>
        <translation>{host} necesita una clave, que se escribiría en el archivo del proyecto: muestre otra fuente</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/sources.py"/>
        <source>{title} has no tiles to show as a background; show another source and come back</source>
        <translation>{title} no tiene teselas que mostrar como fondo; muestre otra fuente y vuelva</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/sources.py"/>
        <source>{title} has tiles in {crs}, which cannot be a background: add its layer with QGIS's Browser panel</source>
        <translation>{title} tiene teselas en {crs}, que no sirven de fondo: añada su capa con el panel Navegador de QGIS</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/sources.py"/>
        <source>{title} numbers its zooms differently from QGIS: add its layer with QGIS's Browser panel</source>
        <translation>{title} numera sus zooms de otro modo que QGIS: añada su capa con el panel Navegador de QGIS</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/sources.py"/>
        <source>{title}: {requests} requests, but its terms allow {most}.</source>
        <translation>{title}: {requests} peticiones, pero sus condiciones permiten {most}.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/sources.py"/>
        <source>{title}: {requests} requests. Over {most} requests require accepting the terms.</source>
        <translation>{title}: {requests} peticiones. Más de {most} peticiones exigen aceptar las condiciones.</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/tasks.py"/>
        <source>layer “{name}” has no CRS: set it in the layer's properties</source>
        <translation>la capa «{name}» no tiene SRC: defínalo en las propiedades de la capa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/tasks.py"/>
        <source>unexpected error: {error}</source>
        <translation>error inesperado: {error}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/units.py"/>
        <source>{count} acres</source>
        <translation>{count} acres</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/units.py"/>
        <source>{count} h</source>
        <translation>{count} h</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/units.py"/>
        <source>{count} min</source>
        <translation>{count} min</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/units.py"/>
        <source>{count} s</source>
        <translation>{count} s</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/units.py"/>
        <source>{count} sq mi</source>
        <translation>{count} mi²</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/widgets.py"/>
        <source>“{text}”: is too small</source>
        <translation>«{text}»: es demasiado pequeño</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/widgets.py"/>
        <source>“{text}”: must be a number</source>
        <translation>«{text}»: debe ser un número</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/widgets.py"/>
        <source>“{text}”: must be a whole number</source>
        <translation>«{text}»: debe ser un número entero</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/widgets.py"/>
        <source>“{text}”: must be above {least} and at most {most}, or empty</source>
        <translation>«{text}»: debe ser mayor que {least} y a lo sumo {most}, o quedar vacío</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/widgets.py"/>
        <source>“{text}”: must be from {least} to {most}</source>
        <translation>«{text}»: debe estar entre {least} y {most}</translation>
    </message>
</context>
<context>
    <name>TerrAInav core</name>
    <message>
        <location filename="../../core/bands.py"/>
        <source>band {0!r}: is named twice</source>
        <translation>banda {0!r}: se nombra dos veces</translation>
    </message>
    <message>
        <location filename="../../core/bands.py"/>
        <source>band {0!r}: {1} has {2}</source>
        <translation>banda {0!r}: {1} tiene {2}</translation>
    </message>
    <message>
        <location filename="../../core/bands.py"/>
        <source>stretch {0!r}: must be {1}, {2}, or two numbers, the lower one first</source>
        <translation>realce {0!r}: debe ser {1}, {2} o dos números, primero el menor</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/answers.py"/>
        <source>predictions {0}: answer no query</source>
        <translation>predicciones {0}: no responden a ninguna consulta</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/answers.py"/>
        <source>predictions {0}: lat_deg and lon_deg go together</source>
        <translation>predicciones {0}: lat_deg y lon_deg van juntas</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/answers.py"/>
        <source>predictions {0}: need the column query, and references or {1}; its columns are {2}</source>
        <translation>predicciones {0}: necesitan la columna query, y references o {1}; sus columnas son {2}</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/answers.py"/>
        <source>predictions: query {0!r} ranks {1:,} tiles, and with {2:,} queries each may rank {3:,} at most</source>
        <translation>predicciones: la consulta {0!r} ordena {1:,} teselas, y con {2:,} consultas cada una puede ordenar {3:,} como máximo</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/answers.py"/>
        <source>reference {0!r} of query {1!r} is not in the benchmark</source>
        <translation>la referencia {0!r} de la consulta {1!r} no está en el banco de pruebas</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/answers.py"/>
        <source>references of query {0!r}: one is named twice</source>
        <translation>referencias de la consulta {0!r}: una se nombra dos veces</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/answers.py"/>
        <source>{0} query {1!r} is answered in line {2} already</source>
        <translation>{0} la consulta {1!r} ya se responde en la línea {2}</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/answers.py"/>
        <source>{0} query {1!r} is not in the benchmark</source>
        <translation>{0} la consulta {1!r} no está en el banco de pruebas</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/answers.py"/>
        <source>{0} {1:g}, {2:g} is not on the Earth</source>
        <translation>{0} {1:g}, {2:g} no está en la Tierra</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/answers.py"/>
        <source>{0} {1} {2:g}: must be a finite number</source>
        <translation>{0} {1} {2:g}: debe ser un número finito</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/features.py"/>
        <source>OpenCV, which finds and matches features, is not installed</source>
        <translation>OpenCV, que encuentra y empareja puntos característicos, no está instalado</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/features.py"/>
        <source>get it with: pip install opencv-python-headless</source>
        <translation>se obtiene con: pip install opencv-python-headless</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/folder.py"/>
        <source>folder {0}: is not a benchmark, as {1} cannot be read ({2})</source>
        <translation>carpeta {0}: no es un banco de pruebas, pues no se puede leer {1} ({2})</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/folder.py"/>
        <source>folder {0}: is not finished</source>
        <translation>carpeta {0}: no está terminada</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/folder.py"/>
        <source>go on{0}</source>
        <translation>continúelo{0}</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/folder.py"/>
        <source>make one first (terrainav benchmark make)</source>
        <translation>haga uno antes (terrainav benchmark make)</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/folder.py"/>
        <source>part {0!r}: must be one of {1}</source>
        <translation>parte {0!r}: debe ser una de {1}</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/folder.py"/>
        <source>part {0!r}: the benchmark in {1} has no such queries</source>
        <translation>parte {0!r}: el banco de pruebas de {1} no tiene tales consultas</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/folder.py"/>
        <source>part {0!r}: the benchmark in {1} was made without parts</source>
        <translation>parte {0!r}: el banco de pruebas de {1} se hizo sin partes</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/folder.py"/>
        <location filename="../../core/dataset/table.py"/>
        <source>table {0}</source>
        <translation>tabla {0}</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/folder.py"/>
        <source>table {0}, line {1}: has {2} cells, not {3}</source>
        <translation>tabla {0}, línea {1}: tiene {2} celdas, no {3}</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/folder.py"/>
        <source>table {0}, line {1}: is not CSV ({2})</source>
        <translation>tabla {0}, línea {1}: no es CSV ({2})</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/folder.py"/>
        <location filename="../../core/dataset/table.py"/>
        <location filename="../../core/exports/croissant.py"/>
        <location filename="../../core/sequences/files.py"/>
        <source>table {0}: cannot be read ({1})</source>
        <translation>tabla {0}: no se puede leer ({1})</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/folder.py"/>
        <source>table {0}: has no column {1}</source>
        <translation>tabla {0}: no tiene la columna {1}</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/folder.py"/>
        <source>table {0}: is empty</source>
        <translation>tabla {0}: está vacía</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/folder.py"/>
        <source>{0} {1!r}: cannot be that of a mosaic</source>
        <translation>{0} {1!r}: no puede ser de un mosaico</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/folder.py"/>
        <source>{0} {1!r}: must be a finite number</source>
        <translation>{0} {1!r}: debe ser un número finito</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/folder.py"/>
        <location filename="../../core/text/plain.py"/>
        <source>{0} {1!r}: must be a number</source>
        <translation>{0} {1!r}: debe ser un número</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/folder.py"/>
        <source>{0}: does not state where the mosaic lies ({1})</source>
        <translation>{0}: no indica dónde está el mosaico ({1})</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/folder.py"/>
        <location filename="../../core/dataset/table.py"/>
        <source>{0}: has column {1} more than once</source>
        <translation>{0}: tiene la columna {1} más de una vez</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/folder.py"/>
        <source>{0}: is not of a benchmark that this version can read</source>
        <translation>{0}: no es de un banco de pruebas que esta versión pueda leer</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/folder.py"/>
        <source>{0}: names {1!r}, which does not exist</source>
        <translation>{0}: nombra {1!r}, que no existe</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/folder.py"/>
        <source>{0}: {1!r} appears twice</source>
        <translation>{0}: {1!r} aparece dos veces</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/folder.py"/>
        <source>{0}: {1!r} is not a file of the benchmark</source>
        <translation>{0}: {1!r} no es un archivo del banco de pruebas</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/folder.py"/>
        <source>{0}: {1} of {2!r} is {3:g}; must be from {4:g} to {5:g}</source>
        <translation>{0}: {1} de {2!r} es {3:g}; debe estar entre {4:g} y {5:g}</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/loading.py"/>
        <source>dtype {0!r}: must be one of {1}</source>
        <translation>dtype {0!r}: debe ser uno de {1}</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/loading.py"/>
        <source>instances: the benchmark in {0} has no buildings</source>
        <translation>instancias: el banco de pruebas en {0} no tiene edificios</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/loading.py"/>
        <source>part {0!r}: the benchmark in {1} has no pairs of it</source>
        <translation>parte {0!r}: el banco de pruebas en {1} no tiene pares de ella</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/loading.py"/>
        <source>shuffle {0!r}: must be True, False or 'auto'</source>
        <translation>shuffle {0!r}: debe ser True, False o 'auto'</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/making.py"/>
        <location filename="../../core/capture/begun.py"/>
        <location filename="../../core/capture/blocks/journal.py"/>
        <location filename="../../core/capture/folder.py"/>
        <location filename="../../core/capture/images.py"/>
        <location filename="../../core/storage/files.py"/>
        <source>choose another folder</source>
        <translation>elija otra carpeta</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/making.py"/>
        <source>folder {0}: already holds this benchmark</source>
        <translation>carpeta {0}: ya contiene este banco de pruebas</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/making.py"/>
        <source>folder {0}: cannot read {1} ({2})</source>
        <translation>carpeta {0}: no se puede leer {1} ({2})</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/making.py"/>
        <source>folder {0}: holds another benchmark</source>
        <translation>carpeta {0}: contiene otro banco de pruebas</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/making.py"/>
        <source>folder {0}: holds {1} but no {2}, so it is not a benchmark</source>
        <translation>carpeta {0}: contiene {1} pero ningún {2}, así que no es un banco de pruebas</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/making.py"/>
        <source>folder {0}: the mosaic of the reference has failed</source>
        <translation>carpeta {0}: el mosaico de la referencia ha fallado</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/making.py"/>
        <source>go on{0} once its source serves, or take a smaller margin</source>
        <translation>continúe{0} cuando la fuente responda, o tome un margen menor</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/making.py"/>
        <location filename="../../core/capture/folder.py"/>
        <source>resume it{0} or choose another folder</source>
        <translation>reanúdela{0} o elija otra carpeta</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/making.py"/>
        <source>with a gap of 0 m</source>
        <translation>con una separación de 0 m</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/making.py"/>
        <source>without a validation part</source>
        <translation>sin parte de validación</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/making.py"/>
        <source>{0:,} of {1:,} queries are in the gap between parts; it would be {2}, and fewer with smaller tiles or over a larger area</source>
        <translation>{0:,} de {1:,} consultas quedan en la separación entre partes; serían {2}, y menos con teselas menores o en una zona mayor</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/making.py"/>
        <source>{0:,} of {1:,} queries are in the gap between parts; smaller tiles or a larger area leave fewer there</source>
        <translation>{0:,} de {1:,} consultas quedan en la separación entre partes; con teselas menores o en una zona mayor quedan menos</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/metrics.py"/>
        <source>first {0} references: must be 1 or more</source>
        <translation>primeras {0} referencias: deben ser 1 o más</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/metrics.py"/>
        <source>rankings of {0} queries: there are {1}</source>
        <translation>clasificaciones de {0} consultas: hay {1}</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/planning.py"/>
        <source>choose a smaller area, or coarser pixels of the queries (--gsd)</source>
        <translation>elija un área menor, o píxeles más gruesos para las consultas (--gsd)</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/planning.py"/>
        <source>choose a smaller gap, an area {0:,.0f} m long or more, or split same-area</source>
        <translation>elija una separación menor, un área de {0:,.0f} m de largo o más, o divida con same-area</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/planning.py"/>
        <location filename="../../core/report/measure.py"/>
        <source>choose other fields</source>
        <translation>elija otros campos</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/planning.py"/>
        <source>intersection over union {0} and {1}: must be above 0, up to 1, and the first not below the second</source>
        <translation>intersección sobre unión {0} y {1}: deben ser mayores que 0, hasta 1, y la primera no menor que la segunda</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/planning.py"/>
        <source>labels {0}: must be left out of a benchmark with reference buildings, whose queries have the masks of buildings alone</source>
        <translation>etiquetas {0}: deben omitirse en un banco de pruebas con edificios de referencia, cuyas consultas solo tienen las máscaras de los edificios</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/planning.py"/>
        <source>lens that distorts: benchmarks state only focal lengths, and need a lens without distortion</source>
        <translation>objetivo que distorsiona: los bancos de pruebas solo indican distancias focales y necesitan un objetivo sin distorsión</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/planning.py"/>
        <source>margin {0} m: must be 0 or more</source>
        <translation>margen {0} m: debe ser 0 o más</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/planning.py"/>
        <source>no imagery of queries: give one or more, such as drone=world</source>
        <translation>no hay imágenes de las consultas: dé una o más, como drone=world</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/planning.py"/>
        <source>overlap of tiles {0}: must be from 0 to below 1</source>
        <translation>solape de las teselas {0}: debe ser desde 0 hasta menos de 1</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/planning.py"/>
        <source>queries of {0}: {1:,} of {2:,} see the horizon, first {3}, and no reference holds their ground</source>
        <translation>consultas de {0}: {1:,} de {2:,} ven el horizonte, la primera {3}, y ninguna referencia contiene su terreno</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/planning.py"/>
        <source>reference of {0:,.0f} x {1:,.0f} m in pixels of {2:.3g} m: more than {3:,} px along a side or {4:,} px</source>
        <translation>referencia de {0:,.0f} x {1:,.0f} m en píxeles de {2:.3g} m: más de {3:,} px por lado o de {4:,} px</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/planning.py"/>
        <source>reference {0}: has no imagery where the queries are</source>
        <translation>referencia {0}: no tiene imágenes donde están las consultas</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/planning.py"/>
        <source>split cross-area: most of {0:,} queries would be in no part, or a part would be empty, as queries and tiles up to {1:,.0f} m wide show the same ground</source>
        <translation>división cross-area: la mayoría de las {0:,} consultas no estaría en ninguna parte, o una parte quedaría vacía, pues consultas y teselas de hasta {1:,.0f} m de ancho muestran el mismo terreno</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/planning.py"/>
        <location filename="../../core/dataset/split.py"/>
        <source>split {0!r}: must be one of {1}</source>
        <translation>división {0!r}: debe ser una de {1}</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/planning.py"/>
        <source>take an area {0:,.0f} m long or more, or split same-area</source>
        <translation>tome un área de {0:,.0f} m de largo o más, o divida con same-area</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/planning.py"/>
        <source>tiles of {0:g} m: the reference has pixels of {1:.3g} m; must be {2:.3g} m wide or wider</source>
        <translation>teselas de {0:g} m: la referencia tiene píxeles de {1:.3g} m; deben tener {2:.3g} m de ancho o más</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/planning.py"/>
        <source>tiles of {0} m: each width may be given once</source>
        <translation>teselas de {0} m: cada anchura puede darse una vez</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/planning.py"/>
        <source>tiles of {0} m: must be wider than 0</source>
        <translation>teselas de {0} m: deben ser más anchas que 0</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/planning.py"/>
        <source>tilt less, or take a narrower camera</source>
        <translation>incline menos, o tome una cámara más estrecha</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/planning.py"/>
        <source>vary {0!r}: benchmarks have one camera</source>
        <translation>vary {0!r}: los bancos de pruebas tienen una sola cámara</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/running.py"/>
        <source>method {0!r}: cannot be imported ({1})</source>
        <translation>método {0!r}: no se puede importar ({1})</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/running.py"/>
        <source>method {0!r}: is not a function</source>
        <translation>método {0!r}: no es una función</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/running.py"/>
        <source>method {0!r}: must be one of {1}, or module:function of your own</source>
        <translation>método {0!r}: debe ser uno de {1}, o módulo:función propios</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/running.py"/>
        <source>method {0}: returns {1}, not a function of a query</source>
        <translation>método {0}: devuelve {1}, no una función de una consulta</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/running.py"/>
        <source>method: answer to {0}:</source>
        <translation>método: respuesta a {0}:</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/running.py"/>
        <source>method: answers {0} with more references than there are: {1:,}</source>
        <translation>método: responde a {0} con más referencias de las que hay: {1:,}</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/running.py"/>
        <source>method: answers {0} with the reference {1}, not a text</source>
        <translation>método: responde a {0} con la referencia {1}, que no es un texto</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/running.py"/>
        <source>method: answers {0} with {1}, not an Answer</source>
        <translation>método: responde a {0} con {1}, no con un Answer</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/running.py"/>
        <source>method: the answer to {0} cannot be read ({1})</source>
        <translation>método: no se puede leer la respuesta a {0} ({1})</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/scoring.py"/>
        <source>leave the tiles of other parts out, or run the method on the part (terrainav benchmark run --part)</source>
        <translation>omita las teselas de otras partes, o ejecute el método en la parte (terrainav benchmark run --part)</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/scoring.py"/>
        <source>nothing was written</source>
        <translation>no se ha escrito nada</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/scoring.py"/>
        <source>predictions</source>
        <translation>predicciones</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/scoring.py"/>
        <source>predictions {0}</source>
        <translation>predicciones {0}</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/scoring.py"/>
        <source>{0}: rank {1}, which is of another part than the queries</source>
        <translation>{0}: clasifican {1}, que es de otra parte que las consultas</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/sequences.py"/>
        <source>predictions {0}: need the columns query, lat_deg and lon_deg; its columns are {1}</source>
        <translation>predicciones {0}: necesitan las columnas query, lat_deg y lon_deg; sus columnas son {1}</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/sequences.py"/>
        <source>{0} frame {1!r} is answered in line {2} already</source>
        <translation>{0} el fotograma {1!r} ya tiene respuesta en la línea {2}</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/sequences.py"/>
        <source>{0} frame {1!r} is not in the sequence</source>
        <translation>{0} el fotograma {1!r} no está en la secuencia</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/silhouettes.py"/>
        <source>benchmark {0}: does not say how to render its buildings</source>
        <translation>banco de pruebas {0}: no indica cómo representar sus edificios</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/silhouettes.py"/>
        <source>benchmark {0}: has buildings, but no elevation that they stand on</source>
        <translation>banco de pruebas {0}: tiene edificios, pero ninguna elevación sobre la que se asienten</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/silhouettes.py"/>
        <source>benchmark {0}: has no buildings</source>
        <translation>banco de pruebas {0}: no tiene edificios</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/silhouettes.py"/>
        <source>benchmark {0}: names buildings outside of it</source>
        <translation>banco de pruebas {0}: nombra edificios fuera de su carpeta</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/silhouettes.py"/>
        <source>make one with buildings (terrainav benchmark make --reference-buildings)</source>
        <translation>cree uno con edificios (terrainav benchmark make --reference-buildings)</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/silhouettes.py"/>
        <source>reference buildings {0}: another file has this name, too</source>
        <translation>edificios de referencia {0}: otro archivo también tiene este nombre</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/silhouettes.py"/>
        <source>reference buildings {0}: must be a file on this computer</source>
        <translation>edificios de referencia {0}: debe ser un archivo de este equipo</translation>
    </message>
    <message>
        <location filename="../../core/benchmark/silhouettes.py"/>
        <source>rename one of them</source>
        <translation>cambie el nombre de uno de ellos</translation>
    </message>
    <message>
        <location filename="../../core/camera/varying.py"/>
        <source>at least one value</source>
        <translation>al menos un valor</translation>
    </message>
    <message>
        <location filename="../../core/camera/varying.py"/>
        <source>hardly any values lie within these bounds</source>
        <translation>apenas hay valores dentro de estos límites</translation>
    </message>
    <message>
        <location filename="../../core/camera/varying.py"/>
        <source>its values are not finite</source>
        <translation>sus valores no son finitos</translation>
    </message>
    <message>
        <location filename="../../core/camera/varying.py"/>
        <source>low above 0 and below high</source>
        <translation>low mayor que 0 y menor que high</translation>
    </message>
    <message>
        <location filename="../../core/camera/varying.py"/>
        <source>low below high</source>
        <translation>low menor que high</translation>
    </message>
    <message>
        <location filename="../../core/camera/varying.py"/>
        <source>low below high, and mode from low to high</source>
        <translation>low menor que high, y mode de low a high</translation>
    </message>
    <message>
        <location filename="../../core/camera/varying.py"/>
        <source>median and sigma above 0</source>
        <translation>median y sigma mayores que 0</translation>
    </message>
    <message>
        <location filename="../../core/camera/varying.py"/>
        <source>must be as {0}</source>
        <translation>debe ser como {0}</translation>
    </message>
    <message>
        <location filename="../../core/camera/varying.py"/>
        <source>only distributions without bounds are cut off</source>
        <translation>solo se recortan las distribuciones sin límites</translation>
    </message>
    <message>
        <location filename="../../core/camera/varying.py"/>
        <source>sd above 0</source>
        <translation>sd mayor que 0</translation>
    </message>
    <message>
        <location filename="../../core/camera/varying.py"/>
        <location filename="../../core/mission/mission.py"/>
        <location filename="../../core/mission/parts/varied.py"/>
        <source>vary {0!r}: {1}</source>
        <translation>vary {0!r}: {1}</translation>
    </message>
    <message>
        <location filename="../../core/camera/varying.py"/>
        <source>{0} must be numbers</source>
        <translation>{0} deben ser números</translation>
    </message>
    <message>
        <location filename="../../core/camera/varying.py"/>
        <source>{0} must be one of {1}</source>
        <translation>{0} debe ser una de {1}</translation>
    </message>
    <message>
        <location filename="../../core/camera/varying.py"/>
        <source>{0} needs {1}</source>
        <translation>{0} necesita {1}</translation>
    </message>
    <message>
        <location filename="../../core/camera/varying.py"/>
        <source>{0} takes {1}</source>
        <translation>{0} requiere {1}</translation>
    </message>
    <message>
        <location filename="../../core/capture/begun.py"/>
        <source>another one</source>
        <translation>otro</translation>
    </message>
    <message>
        <location filename="../../core/capture/begun.py"/>
        <source>it holds no mission</source>
        <translation>no contiene ninguna misión</translation>
    </message>
    <message>
        <location filename="../../core/capture/begun.py"/>
        <source>it holds no settings of this version</source>
        <translation>no contiene ajustes de esta versión</translation>
    </message>
    <message>
        <location filename="../../core/capture/begun.py"/>
        <location filename="../../core/imagery/catalogue.py"/>
        <location filename="../../core/imagery/raster/source.py"/>
        <location filename="../../core/imagery/services/capabilities.py"/>
        <location filename="../../core/imagery/services/ogc.py"/>
        <location filename="../../core/imagery/systems.py"/>
        <location filename="../../core/mission/cameras.py"/>
        <source>none</source>
        <translation>ninguno</translation>
    </message>
    <message>
        <location filename="../../core/capture/begun.py"/>
        <source>others</source>
        <translation>otros</translation>
    </message>
    <message>
        <location filename="../../core/capture/begun.py"/>
        <source>put it back as it was or choose another folder</source>
        <translation>vuelva a dejarlo como estaba o elija otra carpeta</translation>
    </message>
    <message>
        <location filename="../../core/capture/begun.py"/>
        <source>{0:,} values</source>
        <translation>{0:,} valores</translation>
    </message>
    <message>
        <location filename="../../core/capture/begun.py"/>
        <location filename="../../core/dataset/dataset.py"/>
        <source>{0} and {1:,} more</source>
        <translation>{0} y {1:,} más</translation>
    </message>
    <message>
        <location filename="../../core/capture/begun.py"/>
        <source>{0} from {1} to {2}</source>
        <translation>{0} de {1} a {2}</translation>
    </message>
    <message>
        <location filename="../../core/capture/begun.py"/>
        <source>{0} that differ</source>
        <translation>{0} que difieren</translation>
    </message>
    <message>
        <location filename="../../core/capture/begun.py"/>
        <location filename="../../core/capture/blocks/journal.py"/>
        <source>{0}: its {1} cannot be read ({2}), so it is not known how it was begun</source>
        <translation>{0}: su {1} no se puede leer ({2}), por lo que no se sabe cómo se empezó</translation>
    </message>
    <message>
        <location filename="../../core/capture/begun.py"/>
        <source>{0}: its {1} was edited since the capture began: {2}</source>
        <translation>{0}: su {1} se modificó después de comenzar la captura: {2}</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/block.py"/>
        <source>{0}: has no {1} any more</source>
        <translation>{0}: ya no tiene {1}</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/block.py"/>
        <location filename="../../core/imagery/mbtiles.py"/>
        <source>{0}: {1} cannot be read ({2})</source>
        <translation>{0}: {1} no se puede leer ({2})</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/division.py"/>
        <source>block {0!r}: must be 1 to {1:,} images, such as 256, or their size in MB, such as 200MB</source>
        <translation>bloque {0!r}: debe tener de 1 a {1:,} imágenes, como 256, o su tamaño en MB, como 200MB</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/engines.py"/>
        <source>cannot import TerrAInav ({0}: {1})</source>
        <translation>no puede importar TerrAInav ({0}: {1})</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/engines.py"/>
        <source>cluster local:{0}: its processes cannot be started ({1})</source>
        <translation>clúster local:{0}: no se pueden iniciar sus procesos ({1})</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/engines.py"/>
        <source>cluster {0!r}: must be local:N, N processes here up to {1:,}, or such as dask://127.0.0.1:8786</source>
        <translation>clúster {0!r}: debe ser local:N, con hasta {1:,} procesos aquí, o como dask://127.0.0.1:8786</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/engines.py"/>
        <source>cluster {0}: no scheduler answers there</source>
        <translation>clúster {0}: ahí no responde ningún planificador</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/engines.py"/>
        <source>cluster: {0:,} of {1:,} workers cannot make blocks: {2} {3}</source>
        <translation>clúster: {0:,} de {1:,} procesos no pueden hacer bloques: {2} {3}</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/engines.py"/>
        <source>clusters: Dask's distributed cannot be imported ({0})</source>
        <translation>clústeres: no se puede importar distributed de Dask ({0})</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/engines.py"/>
        <source>credentials are taken from Dask's own configuration</source>
        <translation>las credenciales se toman de la configuración de Dask</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/engines.py"/>
        <source>get it with: pip install 'terrainav[cluster]'</source>
        <translation>instálelo con: pip install 'terrainav[cluster]'</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/engines.py"/>
        <source>has Python {0}, and the run has {1}</source>
        <translation>tiene Python {0}, y la ejecución tiene {1}</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/engines.py"/>
        <source>has TerrAInav {0}, and the run has {1}</source>
        <translation>tiene TerrAInav {0}, y la ejecución tiene {1}</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/engines.py"/>
        <source>has no TerrAInav</source>
        <translation>no tiene TerrAInav</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/engines.py"/>
        <source>has no {0}, which TerrAInav needs</source>
        <translation>no tiene {0}, que TerrAInav necesita</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/engines.py"/>
        <source>install it there: pip install 'terrainav[cluster]=={0}'</source>
        <translation>instálelo allí: pip install 'terrainav[cluster]=={0}'</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/journal.py"/>
        <location filename="../../core/capture/folder.py"/>
        <source>capture it first</source>
        <translation>captúrela primero</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/journal.py"/>
        <source>folder {0}: was captured without blocks</source>
        <translation>carpeta {0}: se capturó sin bloques</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/journal.py"/>
        <source>it holds no object</source>
        <translation>no contiene ningún objeto</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/journal.py"/>
        <source>{0}: holds no capture in blocks of this mission, so nothing of it has failed</source>
        <translation>{0}: no contiene ninguna captura por bloques de esta misión, así que nada de ella ha fallado</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/journal.py"/>
        <source>{0}: holds this mission with other images, because the source or the version was another</source>
        <translation>{0}: contiene esta misión con otras imágenes, porque la fuente o la versión era otra</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/journal.py"/>
        <source>{0}: was begun with the layout {1} and blocks of {2} images: it goes on with the same</source>
        <translation>{0}: se empezó con la disposición {1} y bloques de {2} imágenes: continúa con las mismas</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/running.py"/>
        <source>address {0}: is of this process alone, and workers are others: must be a folder, or begin with {1}</source>
        <translation>dirección {0}: es solo de este proceso, y los procesos de trabajo son otros: debe ser una carpeta o empezar por {1}</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/running.py"/>
        <source>block {0}: {1}, {2} times: given up</source>
        <translation>bloque {0}: {1}, {2} veces: se abandona</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/running.py"/>
        <source>block {0}: {1}: it is begun again</source>
        <translation>bloque {0}: {1}: se empieza de nuevo</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/running.py"/>
        <source>install it on each</source>
        <translation>instálelo en cada uno</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/running.py"/>
        <source>install it on each, of the same version</source>
        <translation>instálelo en cada uno, de la misma versión</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/running.py"/>
        <source>its worker died</source>
        <translation>su proceso de trabajo murió</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/running.py"/>
        <source>resume it{0} once they are well</source>
        <translation>reanúdela{0} cuando estén bien</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/running.py"/>
        <source>workers: all are gone ({0})</source>
        <translation>procesos de trabajo: han desaparecido todos ({0})</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/running.py"/>
        <source>workers: none is there: waiting for one</source>
        <translation>procesos de trabajo: no hay ninguno: se espera a uno</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/running.py"/>
        <source>workers: not all have TerrAInav {0}</source>
        <translation>procesos de trabajo: no todos tienen TerrAInav {0}</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/running.py"/>
        <source>workers: not all have what TerrAInav needs ({0})</source>
        <translation>procesos: no todos tienen lo que TerrAInav necesita ({0})</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/running.py"/>
        <source>workers: {0:,} there: going on</source>
        <translation>procesos de trabajo: hay {0:,}: se continúa</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/running.py"/>
        <source>workers: {0} blocks in a row could not be made ({1})</source>
        <translation>procesos de trabajo: {0} bloques seguidos no se pudieron hacer ({1})</translation>
    </message>
    <message>
        <location filename="../../core/capture/blocks/running.py"/>
        <source>{0} on its worker ({1})</source>
        <translation>{0} en su proceso de trabajo ({1})</translation>
    </message>
    <message>
        <location filename="../../core/capture/folder.py"/>
        <source>folder {0}: holds no capture of this mission, so nothing of it has failed</source>
        <translation>carpeta {0}: no contiene ninguna captura de esta misión, así que nada de ella ha fallado</translation>
    </message>
    <message>
        <location filename="../../core/capture/folder.py"/>
        <source>{0} {1}: already holds this mission</source>
        <translation>{0} {1}: ya contiene esta misión</translation>
    </message>
    <message>
        <location filename="../../core/capture/folder.py"/>
        <source>{0} {1}: holds another mission</source>
        <translation>{0} {1}: contiene otra misión</translation>
    </message>
    <message>
        <location filename="../../core/capture/folder.py"/>
        <source>{0} {1}: holds {2} but no {3}, so it is not this mission's</source>
        <translation>{0} {1}: contiene {2} pero no {3}, así que no es de esta misión</translation>
    </message>
    <message>
        <location filename="../../core/capture/georeference.py"/>
        <source>edges {0} m (west, south, east, north): need west &lt; east and south &lt; north</source>
        <translation>bordes {0} m (oeste, sur, este, norte): hace falta oeste &lt; este y sur &lt; norte</translation>
    </message>
    <message>
        <location filename="../../core/capture/georeference.py"/>
        <source>image of {0} x {1} px: needs at least one pixel</source>
        <translation>imagen de {0} x {1} px: necesita al menos un píxel</translation>
    </message>
    <message>
        <location filename="../../core/capture/holding.py"/>
        <source>address {0}: another run is at work there</source>
        <translation>dirección {0}: otra ejecución está trabajando ahí</translation>
    </message>
    <message>
        <location filename="../../core/capture/holding.py"/>
        <location filename="../../core/storage/files.py"/>
        <source>folder {0}: another run is at work in it</source>
        <translation>carpeta {0}: otra ejecución está trabajando en ella</translation>
    </message>
    <message>
        <location filename="../../core/capture/holding.py"/>
        <source>folder {0}: its {1} was replaced or removed, so that another run may be at work in it</source>
        <translation>carpeta {0}: su {1} se sustituyó o se eliminó, de modo que otra ejecución puede estar trabajando en ella</translation>
    </message>
    <message>
        <location filename="../../core/capture/holding.py"/>
        <source>wait until it has ended</source>
        <translation>espere a que termine</translation>
    </message>
    <message>
        <location filename="../../core/capture/holding.py"/>
        <source>{0} {1}: another run has taken over, as this one gave no sign of life for {2:g} s</source>
        <translation>{0} {1}: otra ejecución ha tomado el relevo, ya que esta no dio señales de vida durante {2:g} s</translation>
    </message>
    <message>
        <location filename="../../core/capture/images.py"/>
        <source>capture {0} of the plan: it has 0 to {1}</source>
        <translation>captura {0} del plan: tiene de 0 a {1}</translation>
    </message>
    <message>
        <location filename="../../core/capture/images.py"/>
        <location filename="../../terrainav_plugin/dataset/mosaic.py"/>
        <source>close what shows it</source>
        <translation>cierre lo que lo muestra</translation>
    </message>
    <message>
        <location filename="../../core/capture/images.py"/>
        <source>file {0}: cannot be removed ({1})</source>
        <translation>archivo {0}: no se puede eliminar ({1})</translation>
    </message>
    <message>
        <location filename="../../core/capture/images.py"/>
        <source>folder {0}: holds this mission with other images, such as {1}, because the source or the version was another</source>
        <translation>carpeta {0}: contiene esta misión con otras imágenes, como {1}, porque la fuente o la versión era otra</translation>
    </message>
    <message>
        <location filename="../../core/capture/images.py"/>
        <source>folder {0}: was captured in blocks</source>
        <translation>carpeta {0}: se capturó en bloques</translation>
    </message>
    <message>
        <location filename="../../core/capture/journal.py"/>
        <source>folder {0}: another run has taken over, as its {1} shows</source>
        <translation>carpeta {0}: otra ejecución ha tomado el relevo, según su {1}</translation>
    </message>
    <message>
        <location filename="../../core/capture/journal.py"/>
        <location filename="../../core/mission/export/geopackage.py"/>
        <location filename="../../core/storage/files.py"/>
        <location filename="../../terrainav_plugin/remote/copies.py"/>
        <source>folder {0}: cannot write {1} ({2})</source>
        <translation>carpeta {0}: no se puede escribir {1} ({2})</translation>
    </message>
    <message>
        <location filename="../../core/capture/journal.py"/>
        <source>journal {0}: cannot be read ({1})</source>
        <translation>diario {0}: no se puede leer ({1})</translation>
    </message>
    <message>
        <location filename="../../core/capture/journal.py"/>
        <source>journal {0}: is not open</source>
        <translation>diario {0}: no está abierto</translation>
    </message>
    <message>
        <location filename="../../core/capture/labels.py"/>
        <source>choose another folder, or restore the layers</source>
        <translation>elija otra carpeta o restaure las capas</translation>
    </message>
    <message>
        <location filename="../../core/capture/labels.py"/>
        <source>folder {0}: its {1} is of other labels, as layers have changed since its images were made</source>
        <translation>carpeta {0}: su {1} es de otras etiquetas, pues las capas han cambiado desde que se hicieron sus imágenes</translation>
    </message>
    <message>
        <location filename="../../core/capture/making.py"/>
        <source>image format {0}: has grey, or red, green and blue of 8 bits, and {1} gives {2}</source>
        <translation>formato de imagen {0}: tiene gris, o rojo, verde y azul de 8 bits, y {1} da {2}</translation>
    </message>
    <message>
        <location filename="../../core/capture/making.py"/>
        <source>images of {0:,} px with {1} bands of {2}: more than {3:,} bytes each</source>
        <translation>imágenes de {0:,} px con {1} bandas de {2}: más de {3:,} bytes cada una</translation>
    </message>
    <message>
        <location filename="../../core/capture/making.py"/>
        <location filename="../../core/dataset/dataset.py"/>
        <location filename="../../core/imagery/staticmap.py"/>
        <location filename="../../core/imagery/xyz.py"/>
        <source>map type {0!r}: {1} has {2}</source>
        <translation>tipo de mapa {0!r}: {1} tiene {2}</translation>
    </message>
    <message>
        <location filename="../../core/capture/making.py"/>
        <source>plan is for another pixel grid than that of {0}: plan with the source's own</source>
        <translation>el plan es para otra cuadrícula de píxeles que la de {0}: planifique con la de la fuente</translation>
    </message>
    <message>
        <location filename="../../core/capture/making.py"/>
        <source>sun {0}: {1} was opened in another light than the mission's</source>
        <translation>sol {0}: {1} se abrió con otra luz que la de la misión</translation>
    </message>
    <message>
        <location filename="../../core/capture/pipeline.py"/>
        <source>not begun: the run was stopped</source>
        <translation>no se ha empezado: se detuvo la ejecución</translation>
    </message>
    <message>
        <location filename="../../core/capture/runner.py"/>
        <source>capture in blocks: needs a source by its name, and is of all captures of a plan</source>
        <translation>captura en bloques: necesita una fuente por su nombre, y abarca todas las capturas de un plan</translation>
    </message>
    <message>
        <location filename="../../core/capture/runner.py"/>
        <source>connections</source>
        <translation>conexiones</translation>
    </message>
    <message>
        <location filename="../../core/capture/runner.py"/>
        <source>source {0!r}: must be opened, but for a capture in blocks</source>
        <translation>fuente {0!r}: debe estar abierta, salvo para una captura en bloques</translation>
    </message>
    <message>
        <location filename="../../core/capture/runner.py"/>
        <source>workers</source>
        <translation>procesos de trabajo</translation>
    </message>
    <message>
        <location filename="../../core/capture/runner.py"/>
        <source>{0} {1}: must be 1 or more</source>
        <translation>{0} {1}: debe ser 1 o más</translation>
    </message>
    <message>
        <location filename="../../core/capture/several.py"/>
        <source>imageries {0}: need a plan and a source each</source>
        <translation>imágenes {0}: necesitan un plan y una fuente cada una</translation>
    </message>
    <message>
        <location filename="../../core/capture/writers.py"/>
        <source>choose tif or png, or shorten the source's attribution</source>
        <translation>elija tif o png, o abrevie la atribución de la fuente</translation>
    </message>
    <message>
        <location filename="../../core/capture/writers.py"/>
        <source>description of an image in {0} bytes: a JPEG has room for {1}</source>
        <translation>descripción de una imagen en {0} bytes: un JPEG tiene sitio para {1}</translation>
    </message>
    <message>
        <location filename="../../core/dataset/cameras.py"/>
        <source>image {0}: has lens {1!r}, and must have one of {2}</source>
        <translation>imagen {0}: tiene el objetivo {1!r} y debe tener uno de {2}</translation>
    </message>
    <message>
        <location filename="../../core/dataset/cameras.py"/>
        <source>image {0}: has {1} {2!r}, not a number</source>
        <translation>imagen {0}: tiene {1} {2!r}, que no es un número</translation>
    </message>
    <message>
        <location filename="../../core/dataset/cameras.py"/>
        <source>image {0}: the table does not state its {1}</source>
        <translation>imagen {0}: la tabla no indica su {1}</translation>
    </message>
    <message>
        <location filename="../../core/dataset/cells.py"/>
        <source>has {0} cells, not {1}</source>
        <translation>tiene {0} celdas, no {1}</translation>
    </message>
    <message>
        <location filename="../../core/dataset/cells.py"/>
        <source>{0}: line {1} is not CSV ({2})</source>
        <translation>{0}: la línea {1} no es CSV ({2})</translation>
    </message>
    <message>
        <location filename="../../core/dataset/clean.py"/>
        <source>entropy {0}: must be from 0 to {1:g} bits</source>
        <translation>entropía {0}: debe estar entre 0 y {1:g} bits</translation>
    </message>
    <message>
        <location filename="../../core/dataset/clean.py"/>
        <source>stopped while files were moved: run it again to finish, or undo to put all back</source>
        <translation>detenido mientras se movían archivos: ejecútelo de nuevo para terminar, o deshaga para devolverlo todo a su sitio</translation>
    </message>
    <message>
        <location filename="../../core/dataset/dataset.py"/>
        <source>capture it again, or put the table right</source>
        <translation>captúrela de nuevo o corrija la tabla</translation>
    </message>
    <message>
        <location filename="../../core/dataset/dataset.py"/>
        <source>channels {0}: must be 1 or 3</source>
        <translation>canales {0}: deben ser 1 o 3</translation>
    </message>
    <message>
        <location filename="../../core/dataset/dataset.py"/>
        <source>file {0}: cannot be moved to {1} ({2})</source>
        <translation>archivo {0}: no se puede mover a {1} ({2})</translation>
    </message>
    <message>
        <location filename="../../core/dataset/dataset.py"/>
        <source>finish the capture{0}, or remove what does not belong to it</source>
        <translation>termine la captura{0} o quite lo que no le pertenece</translation>
    </message>
    <message>
        <location filename="../../core/dataset/dataset.py"/>
        <location filename="../../core/dataset/folder.py"/>
        <location filename="../../core/storage/files.py"/>
        <location filename="../../core/storage/stores.py"/>
        <source>folder {0}: cannot be read ({1})</source>
        <translation>carpeta {0}: no se puede leer ({1})</translation>
    </message>
    <message>
        <location filename="../../core/dataset/dataset.py"/>
        <source>folder {0}: the table has {1} in more than one row</source>
        <translation>carpeta {0}: la tabla tiene {1} en más de una fila</translation>
    </message>
    <message>
        <location filename="../../core/dataset/dataset.py"/>
        <source>folder {0}: {1!r} in the table is not a file name</source>
        <translation>carpeta {0}: {1!r} en la tabla no es el nombre de un archivo en ella</translation>
    </message>
    <message>
        <location filename="../../core/dataset/dataset.py"/>
        <source>folder {0}: {1} are in it and in {2} as well</source>
        <translation>carpeta {0}: {1} están en ella y también en {2}</translation>
    </message>
    <message>
        <location filename="../../core/dataset/dataset.py"/>
        <source>folder {0}: {1} are not in the table</source>
        <translation>carpeta {0}: {1} no figuran en la tabla</translation>
    </message>
    <message>
        <location filename="../../core/dataset/dataset.py"/>
        <source>folder {0}: {1} in it is not a folder, so images cannot be moved to it</source>
        <translation>carpeta {0}: {1}, en ella, no es una carpeta a la que mover imágenes</translation>
    </message>
    <message>
        <location filename="../../core/dataset/dataset.py"/>
        <source>folder {0}: {1} is in it and in {2} as well</source>
        <translation>carpeta {0}: {1} está en ella y también en {2}</translation>
    </message>
    <message>
        <location filename="../../core/dataset/dataset.py"/>
        <source>folder {0}: {1} is not in the table</source>
        <translation>carpeta {0}: {1} no figura en la tabla</translation>
    </message>
    <message>
        <location filename="../../core/dataset/dataset.py"/>
        <source>folder {0}: {1} of the table are not there</source>
        <translation>carpeta {0}: {1} de la tabla no están en ella</translation>
    </message>
    <message>
        <location filename="../../core/dataset/dataset.py"/>
        <source>folder {0}: {1} of the table is not there</source>
        <translation>carpeta {0}: {1} de la tabla no está en ella</translation>
    </message>
    <message>
        <location filename="../../core/dataset/dataset.py"/>
        <source>image {0}: cannot be read (it is not a JPEG, PNG or TIFF)</source>
        <translation>imagen {0}: no se puede leer (no es JPEG, PNG ni TIFF)</translation>
    </message>
    <message>
        <location filename="../../core/dataset/dataset.py"/>
        <location filename="../../core/dataset/ground.py"/>
        <location filename="../../core/mosaic/frames.py"/>
        <location filename="../../core/report/sharpness.py"/>
        <location filename="../../core/storage/files.py"/>
        <source>image {0}: cannot be read ({1})</source>
        <translation>imagen {0}: no se puede leer ({1})</translation>
    </message>
    <message>
        <location filename="../../core/dataset/dataset.py"/>
        <source>image {0}: has pixels of Pillow's mode {1}; must be 8-bit grey or colour</source>
        <translation>imagen {0}: tiene píxeles del modo {1} de Pillow; lo correcto es gris o color de 8 bits</translation>
    </message>
    <message>
        <location filename="../../core/dataset/dataset.py"/>
        <source>image {0}: has {1:,} x {2:,} px, more than {3:,} in all</source>
        <translation>imagen {0}: tiene {1:,} x {2:,} px, más de {3:,} en total</translation>
    </message>
    <message>
        <location filename="../../core/dataset/dataset.py"/>
        <source>image {0}: has {1} x {2} px, and {3:g} x {4:g} px in the table</source>
        <translation>imagen {0}: tiene {1} x {2} px, y {3:g} x {4:g} px en la tabla</translation>
    </message>
    <message>
        <location filename="../../core/dataset/dataset.py"/>
        <source>image {0}: has {1}, and not grey or colours of 8 bits</source>
        <translation>imagen {0}: tiene {1}, y no gris ni colores de 8 bits</translation>
    </message>
    <message>
        <location filename="../../core/dataset/dataset.py"/>
        <location filename="../../core/dataset/stored.py"/>
        <source>image {0}: is not there</source>
        <translation>imagen {0}: no está</translation>
    </message>
    <message>
        <location filename="../../core/dataset/dataset.py"/>
        <source>its pixels are damaged or cut off</source>
        <translation>sus píxeles están dañados o cortados</translation>
    </message>
    <message>
        <location filename="../../core/dataset/dataset.py"/>
        <source>layout VBN: {0} is in an object store; must be a folder of this machine</source>
        <translation>disposición VBN: {0} está en un almacén de objetos; debe ser una carpeta de este equipo</translation>
    </message>
    <message>
        <location filename="../../core/dataset/dataset.py"/>
        <source>layout {0!r}: must be one of {1}</source>
        <translation>disposición {0!r}: debe ser una de {1}</translation>
    </message>
    <message>
        <location filename="../../core/dataset/dataset.py"/>
        <source>move it away</source>
        <translation>apártelo</translation>
    </message>
    <message>
        <location filename="../../core/dataset/dataset.py"/>
        <source>put it back, or capture again{0}</source>
        <translation>devuélvala a su sitio o capture de nuevo{0}</translation>
    </message>
    <message>
        <location filename="../../core/dataset/dataset.py"/>
        <source>put it back, or capture it again{0}</source>
        <translation>devuélvala a su sitio o captúrela de nuevo{0}</translation>
    </message>
    <message>
        <location filename="../../core/dataset/dataset.py"/>
        <source>put them back, or capture again{0}</source>
        <translation>devuélvalas a su sitio o capture de nuevo{0}</translation>
    </message>
    <message>
        <location filename="../../core/dataset/dataset.py"/>
        <source>remove one of the two</source>
        <translation>quite uno de los dos</translation>
    </message>
    <message>
        <location filename="../../core/dataset/dataset.py"/>
        <source>run it again to finish, or undo to put all back</source>
        <translation>ejecútelo de nuevo para terminar, o deshaga para devolverlo todo a su sitio</translation>
    </message>
    <message>
        <location filename="../../core/dataset/dataset.py"/>
        <source>table {0}: {1} are not on the Earth, first at Lat {2:g}, Lon {3:g}; Lat must be within 90 degrees, Lon within 360</source>
        <translation>tabla {0}: {1} no están en la Tierra, la primera en Lat {2:g}, Lon {3:g}; Lat debe estar dentro de 90 grados y Lon dentro de 360</translation>
    </message>
    <message>
        <location filename="../../core/dataset/dataset.py"/>
        <source>table {0}: {1} is not on the Earth, first at Lat {2:g}, Lon {3:g}; Lat must be within 90 degrees, Lon within 360</source>
        <translation>tabla {0}: {1} no está en la Tierra, la primera en Lat {2:g}, Lon {3:g}; Lat debe estar dentro de 90 grados y Lon dentro de 360</translation>
    </message>
    <message>
        <location filename="../../core/dataset/dataset.py"/>
        <source>take the dtype stored, or capture with a stretch{0}</source>
        <translation>use el dtype stored, o capture con un realce{0}</translation>
    </message>
    <message>
        <location filename="../../core/dataset/entropy.py"/>
        <source>image of shape {0} and type {1}: must be (height, width) or (height, width, 3) of uint8 with at least one pixel</source>
        <translation>imagen de forma {0} y tipo {1}: debe ser (altura, anchura) o (altura, anchura, 3) de uint8 con al menos un píxel</translation>
    </message>
    <message>
        <location filename="../../core/dataset/entropy.py"/>
        <source>stopped while entropies were worked out: nothing was changed</source>
        <translation>detenido mientras se calculaban las entropías: no se ha cambiado nada</translation>
    </message>
    <message>
        <location filename="../../core/dataset/folder.py"/>
        <source>folder {0}: is laid out as the Night Vision supplement is</source>
        <translation>carpeta {0}: está dispuesta como el suplemento de Night Vision</translation>
    </message>
    <message>
        <location filename="../../core/dataset/folder.py"/>
        <source>folder {0}: is not a dataset, as neither it nor a folder in it has a {1}</source>
        <translation>carpeta {0}: no es un conjunto de datos, pues ni ella ni ninguna carpeta en ella tiene {1}</translation>
    </message>
    <message>
        <location filename="../../core/dataset/folder.py"/>
        <source>folder {0}: is one map type of the dataset {1}</source>
        <translation>carpeta {0}: es un tipo de mapa del conjunto de datos {1}</translation>
    </message>
    <message>
        <location filename="../../core/dataset/folder.py"/>
        <source>folder {0}: its images are in shards or in an object store, and here have to be files of a folder</source>
        <translation>carpeta {0}: sus imágenes están en fragmentos o en un almacén de objetos, y aquí deben ser archivos de una carpeta</translation>
    </message>
    <message>
        <location filename="../../core/dataset/folder.py"/>
        <source>folder {0}: the images of its {1} are in {2} and in {3} as well</source>
        <translation>carpeta {0}: las imágenes de su {1} están en {2} y también en {3}</translation>
    </message>
    <message>
        <location filename="../../core/dataset/folder.py"/>
        <source>give that one</source>
        <translation>dé ese</translation>
    </message>
    <message>
        <location filename="../../core/dataset/folder.py"/>
        <source>give the folder of a capture</source>
        <translation>dé la carpeta de una captura</translation>
    </message>
    <message>
        <location filename="../../core/dataset/folder.py"/>
        <source>make a dataset of it first (terrainav convert --dataset VBN)</source>
        <translation>haga primero de ella un conjunto de datos (terrainav convert --dataset VBN)</translation>
    </message>
    <message>
        <location filename="../../core/dataset/folder.py"/>
        <source>move one of the two away</source>
        <translation>retire una de las dos</translation>
    </message>
    <message>
        <location filename="../../core/dataset/ground.py"/>
        <source>folder {0}: the window of {1} in the table lies elsewhere than its Lat and Lon</source>
        <translation>carpeta {0}: la ventana de {1} en la tabla no está en su Lat y Lon</translation>
    </message>
    <message>
        <location filename="../../core/dataset/ground.py"/>
        <source>image {0}: its table has no {1} of it</source>
        <translation>imagen {0}: su tabla no tiene {1} para ella</translation>
    </message>
    <message>
        <location filename="../../core/dataset/ground.py"/>
        <source>image {0}: {1}</source>
        <translation>imagen {0}: {1}</translation>
    </message>
    <message>
        <location filename="../../core/dataset/ground.py"/>
        <source>image {0}: {1} {2:g} in its table: must be from {3:,g} to {4:,g}</source>
        <translation>imagen {0}: {1} {2:g} en su tabla: debe estar entre {3:,g} y {4:,g}</translation>
    </message>
    <message>
        <location filename="../../core/dataset/ground.py"/>
        <source>put back the capture's own</source>
        <translation>reponga el de la propia captura</translation>
    </message>
    <message>
        <location filename="../../core/dataset/ground.py"/>
        <source>put the table right, or split without blocks</source>
        <translation>corrija la tabla o divida sin bloques</translation>
    </message>
    <message>
        <location filename="../../core/dataset/ground.py"/>
        <source>{0}: cannot be read ({1}), and blocks need it for the ground of a turned camera's images: put it back, or split without blocks</source>
        <translation>{0}: no se puede leer ({1}); dice qué terreno muestran las imágenes de una cámara girada, sin lo cual no hay bloques: devuélvalo a su sitio o divida sin bloques</translation>
    </message>
    <message>
        <location filename="../../core/dataset/ground.py"/>
        <source>{0}: has no row of {1}</source>
        <translation>{0}: no tiene fila de {1}</translation>
    </message>
    <message>
        <location filename="../../core/dataset/label_images.py"/>
        <source>capture it with labels</source>
        <translation>captúrelo con etiquetas</translation>
    </message>
    <message>
        <location filename="../../core/dataset/label_images.py"/>
        <source>folder {0}: has no {1}, as it was captured without labels</source>
        <translation>carpeta {0}: no tiene {1}, pues se capturó sin etiquetas</translation>
    </message>
    <message>
        <location filename="../../core/dataset/label_images.py"/>
        <source>image {0}: its shard has no {1}, which are with the first map type of a mission</source>
        <translation>imagen {0}: su fragmento no tiene {1}, que están con el primer tipo de mapa de una misión</translation>
    </message>
    <message>
        <location filename="../../core/dataset/label_images.py"/>
        <source>labels {0}: are not there</source>
        <translation>etiquetas {0}: no están</translation>
    </message>
    <message>
        <location filename="../../core/dataset/label_images.py"/>
        <source>labels {0}: cannot be read ({1})</source>
        <translation>etiquetas {0}: no se pueden leer ({1})</translation>
    </message>
    <message>
        <location filename="../../core/dataset/label_images.py"/>
        <source>labels {0}: must have one channel of whole numbers</source>
        <translation>etiquetas {0}: deben tener un solo canal de números enteros</translation>
    </message>
    <message>
        <location filename="../../core/dataset/label_images.py"/>
        <source>map type {0}: labels are those of the images with distortion</source>
        <translation>tipo de mapa {0}: las etiquetas son las de las imágenes con distorsión</translation>
    </message>
    <message>
        <location filename="../../core/dataset/label_images.py"/>
        <source>take {0}</source>
        <translation>tome {0}</translation>
    </message>
    <message>
        <location filename="../../core/dataset/labels.py"/>
        <source>capture or clean anew</source>
        <translation>capture o limpie de nuevo</translation>
    </message>
    <message>
        <location filename="../../core/dataset/labels.py"/>
        <source>choose mission or utm</source>
        <translation>elija mission o utm</translation>
    </message>
    <message>
        <location filename="../../core/dataset/labels.py"/>
        <source>choose {0}</source>
        <translation>elija {0}</translation>
    </message>
    <message>
        <location filename="../../core/dataset/labels.py"/>
        <source>frame {0!r}: must be {1} or a code like EPSG:32616</source>
        <translation>sistema {0!r}: debe ser {1} o un código como EPSG:32616</translation>
    </message>
    <message>
        <location filename="../../core/dataset/labels.py"/>
        <source>frame {0}: PROJ knows no such system</source>
        <translation>sistema {0}: PROJ no lo conoce</translation>
    </message>
    <message>
        <location filename="../../core/dataset/labels.py"/>
        <source>frame {0}: is {1}, not a projected system in metres, which labels need</source>
        <translation>sistema {0}: es {1}, y no un sistema proyectado en metros, que las etiquetas necesitan</translation>
    </message>
    <message>
        <location filename="../../core/dataset/labels.py"/>
        <source>frame {0}: of {1} positions; needs one or more, with latitudes from -90 to 90</source>
        <translation>sistema {0}: de {1} posiciones; necesita una o más, con latitudes de -90 a 90</translation>
    </message>
    <message>
        <location filename="../../core/dataset/labels.py"/>
        <source>frame {0}: {1} cannot hold all positions, such as {2}</source>
        <translation>sistema {0}: {1} no abarca todas las posiciones, como {2}</translation>
    </message>
    <message>
        <location filename="../../core/dataset/labels.py"/>
        <source>give the code of another one</source>
        <translation>indique el código de otro</translation>
    </message>
    <message>
        <location filename="../../core/dataset/labels.py"/>
        <source>give the code of one</source>
        <translation>indique el código de uno</translation>
    </message>
    <message>
        <location filename="../../core/dataset/labels.py"/>
        <source>has no {0}</source>
        <translation>no tiene {0}</translation>
    </message>
    <message>
        <location filename="../../core/dataset/labels.py"/>
        <source>have it made anew by split</source>
        <translation>haga que la división lo cree de nuevo</translation>
    </message>
    <message>
        <location filename="../../core/dataset/labels.py"/>
        <source>labels: no image is in the training part, which the scaler is fitted on</source>
        <translation>etiquetas: ninguna imagen está en la parte de entrenamiento, a la que se ajusta el escalador</translation>
    </message>
    <message>
        <location filename="../../core/dataset/labels.py"/>
        <source>labels: scaler of {0} columns; need {1}</source>
        <translation>etiquetas: escalador de {0} columnas; se necesitan {1}</translation>
    </message>
    <message>
        <location filename="../../core/dataset/labels.py"/>
        <source>labels: the dataset has no image that is there and not rejected</source>
        <translation>etiquetas: el conjunto de datos no tiene ninguna imagen presente y no rechazada</translation>
    </message>
    <message>
        <location filename="../../core/dataset/labels.py"/>
        <source>names {0}, not {1}</source>
        <translation>nombra {0}, no {1}</translation>
    </message>
    <message>
        <location filename="../../core/dataset/labels.py"/>
        <source>scaler: has {0} means and {1} scales; need as many of each</source>
        <translation>escalador: tiene {0} medias y {1} escalas; se necesitan tantas de unas como de otras</translation>
    </message>
    <message>
        <location filename="../../core/dataset/labels.py"/>
        <source>scaler: mean {0}; must be finite numbers</source>
        <translation>escalador: media {0}; deben ser números finitos</translation>
    </message>
    <message>
        <location filename="../../core/dataset/labels.py"/>
        <source>scaler: scale {0}; must be finite numbers above 0</source>
        <translation>escalador: escala {0}; deben ser números finitos mayores que 0</translation>
    </message>
    <message>
        <location filename="../../core/dataset/labels.py"/>
        <source>scaler: {0} values to fit it to; needs one or more, all finite numbers</source>
        <translation>escalador: {0} valores a los que ajustarlo; necesita uno o más, todos números finitos</translation>
    </message>
    <message>
        <location filename="../../core/dataset/labels.py"/>
        <source>split again, or undo the split</source>
        <translation>divida de nuevo, o deshaga la división</translation>
    </message>
    <message>
        <location filename="../../core/dataset/labels.py"/>
        <source>split anew</source>
        <translation>divida de nuevo</translation>
    </message>
    <message>
        <location filename="../../core/dataset/labels.py"/>
        <source>the images lie in {0} UTM zones ({1}): one frame, {2}, is for all of them</source>
        <translation>las imágenes están en {0} zonas UTM ({1}): un solo marco, {2}, vale para todas</translation>
    </message>
    <message>
        <location filename="../../core/dataset/labels.py"/>
        <source>{0}: a split was interrupted, so the parts of its map types may disagree</source>
        <translation>{0}: se interrumpió una división, así que las partes de sus tipos de mapa pueden no coincidir</translation>
    </message>
    <message>
        <location filename="../../core/dataset/labels.py"/>
        <location filename="../../core/dataset/split.py"/>
        <location filename="../../core/exports/tables.py"/>
        <location filename="../../core/imagery/raster/source.py"/>
        <location filename="../../core/imagery/raster/trust.py"/>
        <location filename="../../core/mission/areas/files.py"/>
        <location filename="../../core/storage/config.py"/>
        <source>{0}: cannot be read ({1})</source>
        <translation>{0}: no se puede leer ({1})</translation>
    </message>
    <message>
        <location filename="../../core/dataset/published.py"/>
        <source>table {0}: {1}</source>
        <translation>tabla {0}: {1}</translation>
    </message>
    <message>
        <location filename="../../core/dataset/published.py"/>
        <source>{0} has another {1} in its row</source>
        <translation>{0} tiene otro {1} en su fila</translation>
    </message>
    <message>
        <location filename="../../core/dataset/split.py"/>
        <source>blocks</source>
        <translation>bloques</translation>
    </message>
    <message>
        <location filename="../../core/dataset/split.py"/>
        <source>blocks of {0:g} m</source>
        <translation>bloques de {0:g} m</translation>
    </message>
    <message>
        <location filename="../../core/dataset/split.py"/>
        <source>blocks of {0} m: must be above 0 m</source>
        <translation>bloques de {0} m: deben ser mayores que 0 m</translation>
    </message>
    <message>
        <location filename="../../core/dataset/split.py"/>
        <source>choose a smaller gap, other blocks or shares, a dataset of more ground, or split shuffled</source>
        <translation>elija una separación menor, otros bloques o proporciones, un conjunto de datos con más terreno, o divida con shuffled</translation>
    </message>
    <message>
        <location filename="../../core/dataset/split.py"/>
        <source>choose blocks, or leave their sizes out</source>
        <translation>elija bloques u omita sus tamaños</translation>
    </message>
    <message>
        <location filename="../../core/dataset/split.py"/>
        <source>choose other blocks or shares, a dataset of more ground, or split shuffled</source>
        <translation>elija otros bloques o proporciones, un conjunto de datos con más terreno, o divida con shuffled</translation>
    </message>
    <message>
        <location filename="../../core/dataset/split.py"/>
        <source>folder {0}: has no image that is there and not rejected, so there is nothing to split</source>
        <translation>carpeta {0}: no tiene ninguna imagen presente y no rechazada, así que no hay nada que dividir</translation>
    </message>
    <message>
        <location filename="../../core/dataset/split.py"/>
        <source>folder {0}: the ground that its images show is not known (they see the horizon, or come from no map), so there are no blocks of it</source>
        <translation>carpeta {0}: no se sabe qué terreno muestran sus imágenes (ven el horizonte o no vienen de ningún mapa), así que no hay bloques</translation>
    </message>
    <message>
        <location filename="../../core/dataset/split.py"/>
        <source>gap of {0} m: must be from 0 to {1:,.0f} m</source>
        <translation>separación de {0} m: debe ser de 0 a {1:,.0f} m</translation>
    </message>
    <message>
        <location filename="../../core/dataset/split.py"/>
        <source>not an earlier split</source>
        <translation>no es una división anterior</translation>
    </message>
    <message>
        <location filename="../../core/dataset/split.py"/>
        <source>shares {0}: add up to {1:g}; must add up to 1</source>
        <translation>proporciones {0}: suman {1:g}; deben sumar 1</translation>
    </message>
    <message>
        <location filename="../../core/dataset/split.py"/>
        <source>shares {0}: must be finite and not below 0</source>
        <translation>proporciones {0}: deben ser finitas y no menores que 0</translation>
    </message>
    <message>
        <location filename="../../core/dataset/split.py"/>
        <source>shares {0}: must be three, of {1}</source>
        <translation>proporciones {0}: deben ser tres, de {1}</translation>
    </message>
    <message>
        <location filename="../../core/dataset/split.py"/>
        <source>split by blocks: most of {0:,} images up to {1:,.0f} m wide would be in no part, as they show the same ground</source>
        <translation>división por bloques: la mayoría de {0:,} imágenes de hasta {1:,.0f} m de ancho no estaría en ninguna parte, pues muestran el mismo terreno</translation>
    </message>
    <message>
        <location filename="../../core/dataset/split.py"/>
        <source>split by {0}: {1} images up to {2:.0f} m wide with a gap of {3:g} m leave one of {4} without images</source>
        <translation>división por {0}: {1} imágenes de hasta {2:.0f} m de ancho con una separación de {3:g} m dejan una de {4} sin imágenes</translation>
    </message>
    <message>
        <location filename="../../core/dataset/split.py"/>
        <source>split into {0}: needs {1} images or more; the dataset has {2}</source>
        <translation>división en {0}: necesita {1} imágenes o más; el conjunto tiene {2}</translation>
    </message>
    <message>
        <location filename="../../core/dataset/split.py"/>
        <source>split shuffled or in-order</source>
        <translation>divida con shuffled o in-order</translation>
    </message>
    <message>
        <location filename="../../core/dataset/split.py"/>
        <source>split {0!r}: has no blocks and no gap</source>
        <translation>división {0!r}: no tiene bloques ni separación</translation>
    </message>
    <message>
        <location filename="../../core/dataset/split.py"/>
        <source>stopped while images were split: nothing was changed</source>
        <translation>detenido mientras se dividían las imágenes: nada ha cambiado</translation>
    </message>
    <message>
        <location filename="../../core/dataset/split.py"/>
        <source>take an area {0:,.0f} m long or more, smaller images or less overlap, or split shuffled</source>
        <translation>tome un área de {0:,.0f} m de largo o más, imágenes más pequeñas o menos solapamiento, o divida con shuffled</translation>
    </message>
    <message>
        <location filename="../../core/dataset/stored.py"/>
        <source>folder {0}: the shard {1} of the table is not there</source>
        <translation>carpeta {0}: el fragmento {1} de la tabla no existe</translation>
    </message>
    <message>
        <location filename="../../core/dataset/stored.py"/>
        <source>folder {0}: the table does not say where in a shard {1} is</source>
        <translation>carpeta {0}: la tabla no dice en qué parte de un fragmento está {1}</translation>
    </message>
    <message>
        <location filename="../../core/dataset/stored.py"/>
        <source>image {0}: has {1:,} bytes; must have {2:,} at most</source>
        <translation>imagen {0}: tiene {1:,} bytes; debe tener {2:,} como máximo</translation>
    </message>
    <message>
        <location filename="../../core/dataset/stored.py"/>
        <source>image {0}: is not where the table says it is, as the shard is damaged or a different one</source>
        <translation>imagen {0}: no está donde dice la tabla, porque el fragmento está dañado o es otro</translation>
    </message>
    <message>
        <location filename="../../core/dataset/stored.py"/>
        <source>put back the shard that belongs to the table</source>
        <translation>devuelva a su sitio el fragmento que corresponde a la tabla</translation>
    </message>
    <message>
        <location filename="../../core/dataset/stored.py"/>
        <source>shard {0}: cannot be read ({1})</source>
        <translation>fragmento {0}: no se puede leer ({1})</translation>
    </message>
    <message>
        <location filename="../../core/dataset/stored.py"/>
        <source>shard {0}: has more than {1} files of one image from byte {2:,} on</source>
        <translation>fragmento {0}: tiene más de {1} archivos de una imagen a partir del byte {2:,}</translation>
    </message>
    <message>
        <location filename="../../core/dataset/stored.py"/>
        <source>shard {0}: is cut short, as it has {1:,} bytes of {2:,.0f} that its images need</source>
        <translation>fragmento {0}: está cortado, porque tiene {1:,} bytes de los {2:,.0f} que necesitan sus imágenes</translation>
    </message>
    <message>
        <location filename="../../core/dataset/stored.py"/>
        <source>shard {0}: is not there</source>
        <translation>fragmento {0}: no existe</translation>
    </message>
    <message>
        <location filename="../../core/dataset/stored.py"/>
        <source>shard {0}: its part of image {1} at byte {2:,} is not a whole file</source>
        <translation>fragmento {0}: lo que tiene de la imagen {1} en el byte {2:,} no es un archivo completo</translation>
    </message>
    <message>
        <location filename="../../core/dataset/stored.py"/>
        <source>shard {0}: states {1:,} bytes for the file at byte {2:,}</source>
        <translation>fragmento {0}: indica {1:,} bytes para el archivo del byte {2:,}</translation>
    </message>
    <message>
        <location filename="../../core/dataset/table.py"/>
        <source>and {0:,} more</source>
        <translation>y {0:,} más</translation>
    </message>
    <message>
        <location filename="../../core/dataset/table.py"/>
        <source>has {0} {1!r}, not a finite number</source>
        <translation>tiene {0} {1!r}, que no es un número finito</translation>
    </message>
    <message>
        <location filename="../../core/dataset/table.py"/>
        <source>has {0} {1!r}, not a number</source>
        <translation>tiene {0} {1!r}, que no es un número</translation>
    </message>
    <message>
        <location filename="../../core/dataset/table.py"/>
        <source>has {0} {1!r}, not a whole number</source>
        <translation>tiene {0} {1!r}, que no es un número entero</translation>
    </message>
    <message>
        <location filename="../../core/dataset/table.py"/>
        <source>has {0} {1!r}, not from {2:.0f} to {3:.0f}</source>
        <translation>tiene {0} {1!r}, que no va de {2:.0f} a {3:.0f}</translation>
    </message>
    <message>
        <location filename="../../core/dataset/table.py"/>
        <source>line {0} {1}</source>
        <translation>la línea {0} {1}</translation>
    </message>
    <message>
        <location filename="../../core/dataset/table.py"/>
        <source>rename or remove all but one</source>
        <translation>renombre o quite todas menos una</translation>
    </message>
    <message>
        <location filename="../../core/dataset/table.py"/>
        <source>repair the table, or remove it to have it written anew</source>
        <translation>repare la tabla, o quítela para que se escriba de nuevo</translation>
    </message>
    <message>
        <location filename="../../core/dataset/table.py"/>
        <source>table column {0} has {1} rows: the image names have {2}</source>
        <translation>la columna {0} de la tabla tiene {1} filas: los nombres de imagen tienen {2}</translation>
    </message>
    <message>
        <location filename="../../core/dataset/table.py"/>
        <source>time_utc {0!r}: is not a time in ISO 8601</source>
        <translation>time_utc {0!r}: no es una hora en formato ISO 8601</translation>
    </message>
    <message>
        <location filename="../../core/dataset/table.py"/>
        <source>{0}: has no column {1}; needs {2}</source>
        <translation>{0}: no tiene la columna {1}; necesita {2}</translation>
    </message>
    <message>
        <location filename="../../core/dataset/vectors.py"/>
        <source>footprints {0}: are not GeoJSON as captures write it, which begins with {1}; a file of another kind is not opened, as it may lead to other files and servers</source>
        <translation>huellas {0}: no son GeoJSON como el que escriben las capturas, que empieza por {1}; un archivo de otra clase no se abre, porque puede llevar a otros archivos y servidores</translation>
    </message>
    <message>
        <location filename="../../core/dataset/vectors.py"/>
        <source>footprints {0}: cannot be read ({1})</source>
        <translation>huellas {0}: no se pueden leer ({1})</translation>
    </message>
    <message>
        <location filename="../../core/dataset/vectors.py"/>
        <source>footprints {0}: hold a &lt; among their first {1} bytes, as documents do that lead to other files and servers; must be written as {2}</source>
        <translation>huellas {0}: contienen un &lt; entre sus primeros {1} bytes, como los documentos que llevan a otros archivos y servidores; debe escribirse como {2}</translation>
    </message>
    <message>
        <location filename="../../core/dataset/vectors.py"/>
        <source>footprints {0}: their crs is not the code of a system; must be a name such as EPSG:25832, or left out for WGS 84</source>
        <translation>huellas {0}: su crs lleva a otro lugar o no es el de un código; debe ser un nombre como EPSG:25832, u omitirse para WGS 84</translation>
    </message>
    <message>
        <location filename="../../core/elevation/datum.py"/>
        <source>, as it lacks the grid {0}</source>
        <translation>, porque le falta la rejilla {0}</translation>
    </message>
    <message>
        <location filename="../../core/elevation/datum.py"/>
        <source>WGS 84 ellipsoid</source>
        <translation>elipsoide WGS 84</translation>
    </message>
    <message>
        <location filename="../../core/elevation/datum.py"/>
        <source>heights over {0}: PROJ has no way to the ellipsoid here{1}</source>
        <translation>alturas sobre {0}: PROJ no tiene aquí ningún camino al elipsoide{1}</translation>
    </message>
    <message>
        <location filename="../../core/elevation/datum.py"/>
        <source>heights over {0}: it does not reach here</source>
        <translation>alturas sobre {0}: no llega hasta aquí</translation>
    </message>
    <message>
        <location filename="../../core/elevation/datum.py"/>
        <source>install it, for example with projsync, or take the ellipsoid and say how far heights are off it ({0})</source>
        <translation>instálela, por ejemplo con projsync, o tome el elipsoide e indique cuánto se apartan las alturas de él ({0})</translation>
    </message>
    <message>
        <location filename="../../core/elevation/datum.py"/>
        <location filename="../../core/imagery/entry.py"/>
        <source>say which{0}</source>
        <translation>indique cuál{0}</translation>
    </message>
    <message>
        <location filename="../../core/elevation/datum.py"/>
        <source>{0}: axis {1!r} of its heights points {2}: must be up or down</source>
        <translation>{0}: el eje {1!r} de sus alturas apunta a {2}: debe ser arriba (up) o abajo (down)</translation>
    </message>
    <message>
        <location filename="../../core/elevation/datum.py"/>
        <source>{0}: heights in {1!r}: must be one of {2}</source>
        <translation>{0}: alturas en {1!r}: debe ser una de {2}</translation>
    </message>
    <message>
        <location filename="../../core/elevation/datum.py"/>
        <source>{0}: its coordinates are in {1}, and it does not say whether its heights are in metres</source>
        <translation>{0}: sus coordenadas están en {1}, y no dice si sus alturas están en metros</translation>
    </message>
    <message>
        <location filename="../../core/elevation/filling.py"/>
        <source>missing heights: are interpolated by GDAL, which is not there: pip install terrainav[raster]</source>
        <translation>alturas que faltan: las interpola GDAL, que no está: pip install terrainav[raster]</translation>
    </message>
    <message>
        <location filename="../../core/elevation/filling.py"/>
        <source>missing heights: cannot be interpolated: {0}</source>
        <translation>alturas que faltan: no se pueden interpolar: {0}</translation>
    </message>
    <message>
        <location filename="../../core/elevation/heights.py"/>
        <source>down</source>
        <translation>hacia abajo</translation>
    </message>
    <message>
        <location filename="../../core/elevation/heights.py"/>
        <source>height {0:g} m: must be from {1:g} to {2:g}</source>
        <translation>altura {0:g} m: debe estar entre {1:g} y {2:g}</translation>
    </message>
    <message>
        <location filename="../../core/elevation/heights.py"/>
        <source>heights {0!r}: are several sources in one</source>
        <translation>alturas {0!r}: son varias fuentes en una</translation>
    </message>
    <message>
        <location filename="../../core/elevation/heights.py"/>
        <source>heights {0!r}: no such source is known</source>
        <translation>alturas {0!r}: no se conoce tal fuente</translation>
    </message>
    <message>
        <location filename="../../core/elevation/heights.py"/>
        <source>heights {0}: is a source of images</source>
        <translation>alturas {0}: es una fuente de imágenes</translation>
    </message>
    <message>
        <location filename="../../core/elevation/heights.py"/>
        <source>heights {0}: {1!r} behind # must be maxzoom or tilesize</source>
        <translation>alturas {0}: {1!r} detrás de # debe ser maxzoom o tilesize</translation>
    </message>
    <message>
        <location filename="../../core/elevation/heights.py"/>
        <source>heights {0}: {1} {2!r} must be a whole number</source>
        <translation>alturas {0}: {1} {2!r} debe ser un número entero</translation>
    </message>
    <message>
        <location filename="../../core/elevation/heights.py"/>
        <source>name a raster file of heights, terrarium or world, or write terrarium: or terrain-rgb: before the address of tiles whose colours are heights</source>
        <translation>nombre un archivo ráster de alturas, terrarium o world, o escriba terrarium: o terrain-rgb: delante de la dirección de teselas cuyos colores son alturas</translation>
    </message>
    <message>
        <location filename="../../core/elevation/heights.py"/>
        <source>name a raster file of heights, terrarium, world or a number of metres</source>
        <translation>nombre un archivo ráster de alturas, terrarium, world o un número de metros</translation>
    </message>
    <message>
        <location filename="../../core/elevation/heights.py"/>
        <source>say so in the file where the value stands for no data, for example with gdal_edit.py -a_nodata</source>
        <translation>dígalo en el archivo si el valor significa que no hay datos, por ejemplo con gdal_edit.py -a_nodata</translation>
    </message>
    <message>
        <location filename="../../core/elevation/heights.py"/>
        <source>up</source>
        <translation>hacia arriba</translation>
    </message>
    <message>
        <location filename="../../core/elevation/heights.py"/>
        <source>write a semicolon between them in QGIS, and a space in a command{0}</source>
        <translation>escriba un punto y coma entre ellas en QGIS, y un espacio en una orden{0}</translation>
    </message>
    <message>
        <location filename="../../core/elevation/heights.py"/>
        <source>{0}: height {1:g} m at latitude {2:.6f}, longitude {3:.6f}: must be from {4:g} to {5:g}, and not {6:g}, which stands for no data elsewhere</source>
        <translation>{0}: altura {1:g} m en la latitud {2:.6f}, longitud {3:.6f}: debe estar entre {4:g} y {5:g}, y no ser {6:g}, que en otros archivos significa sin datos</translation>
    </message>
    <message>
        <location filename="../../core/elevation/heights.py"/>
        <source>{0}: its heights have the scale {1:g} and the offset {2:g}: must be finite, and the scale not 0</source>
        <translation>{0}: sus alturas tienen la escala {1:g} y el desplazamiento {2:g}: deben ser finitos, y la escala no 0</translation>
    </message>
    <message>
        <location filename="../../core/elevation/heights.py"/>
        <source>{0}: its vertical axis points {1}, and that of {2} {3}: must point the same way</source>
        <translation>{0}: su eje vertical apunta {1}, y el de {2}, {3}: deben apuntar en el mismo sentido</translation>
    </message>
    <message>
        <location filename="../../core/exports/croissant.py"/>
        <source>folder {0}: a {1} describes the files beside it</source>
        <translation>carpeta {0}: {1} describe los archivos que tiene a su lado</translation>
    </message>
    <message>
        <location filename="../../core/exports/croissant.py"/>
        <source>give the dataset's own</source>
        <translation>indique la del propio conjunto de datos</translation>
    </message>
    <message>
        <location filename="../../core/exports/formats.py"/>
        <location filename="../../core/exports/kinds.py"/>
        <location filename="../../core/exports/localisers.py"/>
        <location filename="../../core/live/encoding.py"/>
        <source>format {0!r}: must be one of {1}</source>
        <translation>formato {0!r}: debe ser uno de {1}</translation>
    </message>
    <message>
        <location filename="../../core/exports/huggingface.py"/>
        <source>map type {0!r}: has no image to export</source>
        <translation>tipo de mapa {0!r}: no tiene imágenes que exportar</translation>
    </message>
    <message>
        <location filename="../../core/exports/huggingface.py"/>
        <source>stopped while images were exported: nothing is left of the export</source>
        <translation>detenido mientras se exportaban las imágenes: no queda nada de la exportación</translation>
    </message>
    <message>
        <location filename="../../core/exports/kinds.py"/>
        <source>Croissant description</source>
        <translation>Descripción Croissant</translation>
    </message>
    <message>
        <location filename="../../core/exports/kinds.py"/>
        <source>EuRoC dataset (ASL)</source>
        <translation>conjunto de datos EuRoC (ASL)</translation>
    </message>
    <message>
        <location filename="../../core/exports/kinds.py"/>
        <source>Hugging Face datasets</source>
        <translation>Hugging Face</translation>
    </message>
    <message>
        <location filename="../../core/exports/kinds.py"/>
        <location filename="../../core/poses/settings.py"/>
        <source>KITTI trajectory</source>
        <translation>Trayectoria KITTI</translation>
    </message>
    <message>
        <location filename="../../core/exports/kinds.py"/>
        <source>Parquet tables</source>
        <translation>Tablas Parquet</translation>
    </message>
    <message>
        <location filename="../../core/exports/kinds.py"/>
        <source>ROS 2 bag</source>
        <translation>bag de ROS 2</translation>
    </message>
    <message>
        <location filename="../../core/exports/kinds.py"/>
        <source>ROS 2 bag as MCAP</source>
        <translation>bag de ROS 2 en MCAP</translation>
    </message>
    <message>
        <location filename="../../core/exports/kinds.py"/>
        <source>STAC collection</source>
        <translation>Colección STAC</translation>
    </message>
    <message>
        <location filename="../../core/exports/kinds.py"/>
        <location filename="../../core/poses/settings.py"/>
        <source>TUM trajectory</source>
        <translation>Trayectoria TUM</translation>
    </message>
    <message>
        <location filename="../../core/exports/kinds.py"/>
        <source>format {0}: needs the Python package {1}, which is not installed</source>
        <translation>formato {0}: necesita el paquete de Python {1}, que no está instalado</translation>
    </message>
    <message>
        <location filename="../../core/exports/kinds.py"/>
        <source>format {0}: needs the folder to write to</source>
        <translation>formato {0}: necesita la carpeta en la que escribir</translation>
    </message>
    <message>
        <location filename="../../core/exports/kinds.py"/>
        <source>map type {0!r}: benchmarks have none to choose from</source>
        <translation>tipo de mapa {0!r}: los conjuntos de evaluación no tienen ninguno que elegir</translation>
    </message>
    <message>
        <location filename="../../core/exports/label_sets.py"/>
        <source>capture it with both products</source>
        <translation>captúrelo con ambos productos</translation>
    </message>
    <message>
        <location filename="../../core/exports/label_sets.py"/>
        <source>folder {0}: has labels without both {1} and {2}</source>
        <translation>carpeta {0}: tiene etiquetas sin {1} y {2} a la vez</translation>
    </message>
    <message>
        <location filename="../../core/exports/label_sets.py"/>
        <source>labels of {0}: must have the same size in {1} and {2}</source>
        <translation>etiquetas de {0}: deben tener el mismo tamaño en {1} y {2}</translation>
    </message>
    <message>
        <location filename="../../core/exports/label_sets.py"/>
        <source>labels of {0}: the class {1} is not in the table of classes</source>
        <translation>etiquetas de {0}: la clase {1} no está en la tabla de clases</translation>
    </message>
    <message>
        <location filename="../../core/exports/localisers.py"/>
        <source>{0:,} scenes: AnyVisLoc's names have room for {1}</source>
        <translation>{0:,} escenas: en los nombres de AnyVisLoc caben {1}</translation>
    </message>
    <message>
        <location filename="../../core/exports/scenes.py"/>
        <source>benchmark {0}: does not say how its queries were taken</source>
        <translation>banco de pruebas {0}: no dice cómo se tomaron sus consultas</translation>
    </message>
    <message>
        <location filename="../../core/exports/sequences.py"/>
        <source>folder {0}: its frames have no times</source>
        <translation>carpeta {0}: sus fotogramas no tienen hora</translation>
    </message>
    <message>
        <location filename="../../core/exports/sequences.py"/>
        <source>folder {0}: its frames have several cameras, and a sequence has one</source>
        <translation>carpeta {0}: sus fotogramas tienen varias cámaras, y una secuencia tiene una</translation>
    </message>
    <message>
        <location filename="../../core/exports/sequences.py"/>
        <source>get it with: pip install 'terrainav[ros]'</source>
        <translation>instálelo con: pip install 'terrainav[ros]'</translation>
    </message>
    <message>
        <location filename="../../core/exports/sequences.py"/>
        <source>lens with {0} coefficients: EuRoC's files state four</source>
        <translation>objetivo con {0} coeficientes: los archivos de EuRoC indican cuatro</translation>
    </message>
    <message>
        <location filename="../../core/exports/sequences.py"/>
        <source>write a bag (rosbag2)</source>
        <translation>escriba un bag (rosbag2)</translation>
    </message>
    <message>
        <location filename="../../core/exports/sequences.py"/>
        <source>{0}, which writes bags, is not installed</source>
        <translation>{0}, que escribe bags, no está instalado</translation>
    </message>
    <message>
        <location filename="../../core/exports/stac.py"/>
        <location filename="../../core/exports/views.py"/>
        <source>folder {0}: has no image to export</source>
        <translation>carpeta {0}: no tiene imágenes que exportar</translation>
    </message>
    <message>
        <location filename="../../core/exports/tables.py"/>
        <source>folder {0}: its name is not UTF-8, as a description of files needs it</source>
        <translation>carpeta {0}: su nombre no es texto en UTF-8, como lo necesita una descripción de archivos</translation>
    </message>
    <message>
        <location filename="../../core/exports/tables.py"/>
        <source>format {0}: pyarrow cannot be imported ({1})</source>
        <translation>formato {0}: no se puede importar pyarrow ({1})</translation>
    </message>
    <message>
        <location filename="../../core/exports/tables.py"/>
        <source>get it with: pip install 'terrainav[parquet]'</source>
        <translation>se obtiene con: pip install 'terrainav[parquet]'</translation>
    </message>
    <message>
        <location filename="../../core/exports/views.py"/>
        <source>capture camera frames ({0} camera)</source>
        <translation>capture imágenes de cámara ({0} camera)</translation>
    </message>
    <message>
        <location filename="../../core/exports/views.py"/>
        <location filename="../../core/mosaic/frames.py"/>
        <source>folder {0}: has no {1}, which describes the camera</source>
        <translation>carpeta {0}: no tiene {1}, que indica la cámara</translation>
    </message>
    <message>
        <location filename="../../core/exports/views.py"/>
        <source>folder {0}: its images are windows of the map, which no camera takes</source>
        <translation>carpeta {0}: sus imágenes son ventanas del mapa, que ninguna cámara toma</translation>
    </message>
    <message>
        <location filename="../../core/external/compiling.py"/>
        <source>numba cannot be used: {0}</source>
        <translation>numba no se puede usar: {0}</translation>
    </message>
    <message>
        <location filename="../../core/external/compiling.py"/>
        <source>numba is not installed</source>
        <translation>numba no está instalado</translation>
    </message>
    <message>
        <location filename="../../core/external/compiling.py"/>
        <source>numba {0}</source>
        <translation>numba {0}</translation>
    </message>
    <message>
        <location filename="../../core/external/compiling.py"/>
        <source>numpy ({0}); several times as fast with numba, from pip or the package python3-numba</source>
        <translation>numpy ({0}); varias veces más rápido con numba, de pip o del paquete python3-numba</translation>
    </message>
    <message>
        <location filename="../../core/external/compiling.py"/>
        <source>{0} is 0 in the environment</source>
        <translation>{0} es 0 en el entorno</translation>
    </message>
    <message>
        <location filename="../../core/external/drawing.py"/>
        <source>get it with: pip install 'terrainav[report]'</source>
        <translation>se obtiene con: pip install 'terrainav[report]'</translation>
    </message>
    <message>
        <location filename="../../core/external/drawing.py"/>
        <source>matplotlib, which draws the diagrams, is not installed</source>
        <translation>no está instalado matplotlib, que dibuja los diagramas</translation>
    </message>
    <message>
        <location filename="../../core/external/importing.py"/>
        <source>{0}: cannot be imported ({1}); its settings, in a file or the environment, may be wrong</source>
        <translation>{0}: no se puede importar ({1}); puede que su configuración, en un archivo o en el entorno, sea incorrecta</translation>
    </message>
    <message>
        <location filename="../../core/external/native_calls.py"/>
        <source>stopped while a raster was read</source>
        <translation>detenido mientras se leía un ráster</translation>
    </message>
    <message>
        <location filename="../../core/external/unexpected.py"/>
        <source>unexpected error ({0})</source>
        <translation>error inesperado ({0})</translation>
    </message>
    <message>
        <location filename="../../core/external/user_code.py"/>
        <source>method {0}: failed with {1} ({2}, line {3})</source>
        <translation>método {0}: falló con {1} ({2}, línea {3})</translation>
    </message>
    <message>
        <location filename="../../core/faces/city_buildings.py"/>
        <source>buildings are set on the ground ({0})</source>
        <translation>los edificios se ponen sobre el suelo ({0})</translation>
    </message>
    <message>
        <location filename="../../core/faces/city_buildings.py"/>
        <source>buildings are set on the ground, as it states no vertical datum</source>
        <translation>los edificios se ponen sobre el suelo, pues no indica ningún datum vertical</translation>
    </message>
    <message>
        <location filename="../../core/faces/city_buildings.py"/>
        <source>write the right system after the name, such as {0}#crs=EPSG:7415</source>
        <translation>escriba el sistema correcto detrás del nombre, por ejemplo {0}#crs=EPSG:7415</translation>
    </message>
    <message>
        <location filename="../../core/faces/city_buildings.py"/>
        <source>{0:,} buildings are above the ground: their walls are longer</source>
        <translation>{0:,} edificios están por encima del suelo: sus muros se alargan</translation>
    </message>
    <message>
        <location filename="../../core/faces/city_buildings.py"/>
        <source>{0:,} buildings are below the ground</source>
        <translation>{0:,} edificios están por debajo del suelo</translation>
    </message>
    <message>
        <location filename="../../core/faces/city_buildings.py"/>
        <source>{0:,} buildings without ground below are left out</source>
        <translation>se omiten {0:,} edificios sin suelo debajo</translation>
    </message>
    <message>
        <location filename="../../core/faces/city_buildings.py"/>
        <source>{0:,} buildings without surfaces are left out</source>
        <translation>se omiten {0:,} edificios sin superficies</translation>
    </message>
    <message>
        <location filename="../../core/faces/city_buildings.py"/>
        <source>{0:,} of {1:,} textures are missing: plain</source>
        <translation>faltan {0:,} de {1:,} texturas: color liso</translation>
    </message>
    <message>
        <location filename="../../core/faces/city_buildings.py"/>
        <source>{0:,} surfaces and solids were repaired</source>
        <translation>se repararon {0:,} superficies y sólidos</translation>
    </message>
    <message>
        <location filename="../../core/faces/city_buildings.py"/>
        <source>{0:,} surfaces are missing, as they cannot be read</source>
        <translation>faltan {0:,} superficies, pues no se pueden leer</translation>
    </message>
    <message>
        <location filename="../../core/faces/city_buildings.py"/>
        <source>{0:,} surfaces have one colour, as their texture is not placed</source>
        <translation>{0:,} superficies tienen un solo color, porque su textura no está situada</translation>
    </message>
    <message>
        <location filename="../../core/faces/city_buildings.py"/>
        <source>{0:,} triangles are missing, as they lie far off</source>
        <translation>faltan {0:,} triángulos, pues quedan muy lejos</translation>
    </message>
    <message>
        <location filename="../../core/faces/city_buildings.py"/>
        <location filename="../../core/faces/cityjson.py"/>
        <source>{0}: has no buildings with surfaces</source>
        <translation>{0}: no tiene edificios con superficies</translation>
    </message>
    <message>
        <location filename="../../core/faces/city_buildings.py"/>
        <source>{0}: no vertex lies where {1} is defined</source>
        <translation>{0}: ningún vértice está donde {1} está definido</translation>
    </message>
    <message>
        <location filename="../../core/faces/cityjson.py"/>
        <source>line {0}: {1}</source>
        <translation>línea {0}: {1}</translation>
    </message>
    <message>
        <location filename="../../core/faces/cityjson.py"/>
        <source>write it after the name, such as {0}#crs=EPSG:7415</source>
        <translation>escríbalo detrás del nombre, por ejemplo {0}#crs=EPSG:7415</translation>
    </message>
    <message>
        <location filename="../../core/faces/cityjson.py"/>
        <source>{0}: 'scale' of 'transform' is {1}: must not be 0</source>
        <translation>{0}: 'scale' de 'transform' es {1}: no debe ser 0</translation>
    </message>
    <message>
        <location filename="../../core/faces/cityjson.py"/>
        <source>{0}: 'transform' is missing, which CityJSON has since version 1.1</source>
        <translation>{0}: falta 'transform', que CityJSON tiene desde la versión 1.1</translation>
    </message>
    <message>
        <location filename="../../core/faces/cityjson.py"/>
        <source>{0}: CityJSON of version {1!r}: must be 1.0, 1.1 or 2.0</source>
        <translation>{0}: CityJSON de versión {1!r}: debe ser 1.0, 1.1 o 2.0</translation>
    </message>
    <message>
        <location filename="../../core/faces/cityjson.py"/>
        <location filename="../../core/imagery/raster/source.py"/>
        <location filename="../../core/vectors/geojson.py"/>
        <location filename="../../core/vectors/layer.py"/>
        <location filename="../../core/vectors/reading.py"/>
        <source>{0}: cannot be read: {1}</source>
        <translation>{0}: no se puede leer: {1}</translation>
    </message>
    <message>
        <location filename="../../core/faces/cityjson.py"/>
        <source>{0}: level of detail {1!r}: must be a number such as 2 or 1.2</source>
        <translation>{0}: nivel de detalle {1!r}: debe ser un número como 2 o 1.2</translation>
    </message>
    <message>
        <location filename="../../core/faces/cityjson.py"/>
        <source>{0}: object {1} is of type {2!r}: must be {3}</source>
        <translation>{0}: el objeto {1} es de tipo {2!r}: debe ser {3}</translation>
    </message>
    <message>
        <location filename="../../core/faces/cityjson.py"/>
        <source>{0}: states no coordinate reference system</source>
        <translation>{0}: no indica ningún sistema de referencia de coordenadas</translation>
    </message>
    <message>
        <location filename="../../core/faces/cityjson.py"/>
        <source>{0}: {1!r} is missing</source>
        <translation>{0}: falta {1!r}</translation>
    </message>
    <message>
        <location filename="../../core/faces/cityjson.py"/>
        <source>{0}: {1!r} of 'transform' is {2}: must be three numbers</source>
        <translation>{0}: {1!r} de 'transform' es {2}: deben ser tres números</translation>
    </message>
    <message>
        <location filename="../../core/faces/opening.py"/>
        <source>buildings {0}: {1!r} behind # must be crs=CODE, lod=NUMBER, heights=file or heights=ground, each once</source>
        <translation>edificios {0}: {1!r} detrás de # debe ser crs=CÓDIGO, lod=NÚMERO, heights=file o heights=ground, cada uno una vez</translation>
    </message>
    <message>
        <location filename="../../core/fields.py"/>
        <source>a finite number</source>
        <translation>un número finito</translation>
    </message>
    <message>
        <location filename="../../core/fields.py"/>
        <location filename="../../core/imagery/entry.py"/>
        <source>a list</source>
        <translation>una lista</translation>
    </message>
    <message>
        <location filename="../../core/fields.py"/>
        <location filename="../../core/imagery/entry.py"/>
        <source>a number</source>
        <translation>un número</translation>
    </message>
    <message>
        <location filename="../../core/fields.py"/>
        <location filename="../../core/imagery/entry.py"/>
        <source>a whole number</source>
        <translation>un número entero</translation>
    </message>
    <message>
        <location filename="../../core/fields.py"/>
        <source>above {0:g}</source>
        <translation>mayor que {0:g}</translation>
    </message>
    <message>
        <location filename="../../core/fields.py"/>
        <source>at least {0:g} and below {1:g}</source>
        <translation>al menos {0:g} y menor que {1:g}</translation>
    </message>
    <message>
        <location filename="../../core/fields.py"/>
        <source>at least {0}</source>
        <translation>al menos {0}</translation>
    </message>
    <message>
        <location filename="../../core/fields.py"/>
        <source>at most {0:g}</source>
        <translation>como máximo {0:g}</translation>
    </message>
    <message>
        <location filename="../../core/fields.py"/>
        <source>at most {0}</source>
        <translation>como máximo {0}</translation>
    </message>
    <message>
        <location filename="../../core/fields.py"/>
        <source>below {0:g}</source>
        <translation>menor que {0:g}</translation>
    </message>
    <message>
        <location filename="../../core/fields.py"/>
        <source>between {0:g} and {1:g}, both excluded</source>
        <translation>mayor que {0:g} y menor que {1:g}</translation>
    </message>
    <message>
        <location filename="../../core/fields.py"/>
        <source>from {0:g} to {1:g}</source>
        <translation>de {0:g} a {1:g}</translation>
    </message>
    <message>
        <location filename="../../core/fields.py"/>
        <source>of more than 64 bits</source>
        <translation>de más de 64 bits</translation>
    </message>
    <message>
        <location filename="../../core/fields.py"/>
        <source>one of {0}</source>
        <translation>uno de {0}</translation>
    </message>
    <message>
        <location filename="../../core/fields.py"/>
        <location filename="../../core/imagery/entry.py"/>
        <source>text</source>
        <translation>texto</translation>
    </message>
    <message>
        <location filename="../../core/fields.py"/>
        <location filename="../../core/imagery/entry.py"/>
        <source>true or false</source>
        <translation>verdadero o falso</translation>
    </message>
    <message>
        <location filename="../../core/fields.py"/>
        <source>{0:g} or more</source>
        <translation>{0:g} o más</translation>
    </message>
    <message>
        <location filename="../../core/fields.py"/>
        <source>{0} {1}: must be {2}</source>
        <translation>{0} {1}: debe ser {2}</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/accuracy.py"/>
        <source>footprint over Earth's radius times tan(latitude) is {0:.3g}: holds up to {1:g}</source>
        <translation>la huella entre el radio de la Tierra por tan(latitud) es {0:.3g}: vale hasta {1:g}</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/accuracy.py"/>
        <source>height over Earth's radius times tan²(FOV/2) is {0:.3g}: holds up to {1:g}</source>
        <translation>la altura entre el radio de la Tierra por tan²(FOV/2) es {0:.3g}: vale hasta {1:g}</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/accuracy.py"/>
        <source>tilt or roll of {0:g} deg: holds for cameras that look straight down</source>
        <translation>inclinación o alabeo de {0:g} grados: vale para cámaras que miran en vertical</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/camera.py"/>
        <source>{0} {1:g}: a fisheye has k1 to k4 only</source>
        <translation>{0} {1:g}: un ojo de pez solo tiene k1 a k4</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/contract.py"/>
        <source>camera contract of version {0}: must be {1}</source>
        <translation>contrato de cámara de la versión {0}: debe ser {1}</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/contract.py"/>
        <source>camera contract: lacks or misstates {0}</source>
        <translation>contrato de cámara: falta {0} o es incorrecto</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/contract.py"/>
        <source>lens with k4 {0:g}, k5 {1:g} and k6 {2:g}: nerfstudio has no such lens, and COLMAP has</source>
        <translation>objetivo con k4 {0:g}, k5 {1:g} y k6 {2:g}: nerfstudio no tiene ese objetivo, y COLMAP sí</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/distortion.py"/>
        <source>choose a smaller field of view</source>
        <translation>elija un campo de visión menor</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/distortion.py"/>
        <source>choose a smaller field of view, or coefficients that hold in the whole image</source>
        <translation>elija un campo de visión menor, o coeficientes que valgan en toda la imagen</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/distortion.py"/>
        <source>fisheye: its image reaches {0:.3g} focal lengths from the principal point, where a ray is more than {1:.1f} deg off the axis ({2:.3g} focal lengths)</source>
        <translation>ojo de pez: su imagen llega a {0:.3g} distancias focales del punto principal, donde un rayo se aparta más de {1:.1f} grados del eje ({2:.3g} distancias focales)</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/distortion.py"/>
        <source>lens distortion: folds the image at {0:.3g} focal lengths from the principal point, and its farthest corner is at {1:.3g}</source>
        <translation>distorsión del objetivo: pliega la imagen a {0:.3g} distancias focales del punto principal, y su esquina más lejana está a {1:.3g}</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/ellipsoid.py"/>
        <source>ellipsoid semi-axes {0} m, {1} m: need a &gt;= b &gt; 0, both finite</source>
        <translation>semiejes del elipsoide de {0} m, {1} m: hace falta a &gt;= b &gt; 0, ambos finitos</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/footprint.py"/>
        <source>camera at height {0:g} m, yaw {1:g}, tilt {2:g}, roll {3:g} deg: no ray of its image meets the Earth</source>
        <translation>cámara a {0:g} m de altura, guiñada {1:g}, inclinación {2:g}, alabeo {3:g} grados: ningún rayo de su imagen alcanza la Tierra</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/footprint.py"/>
        <source>tilt it down</source>
        <translation>inclínela hacia abajo</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/frames.py"/>
        <source>fly lower or narrow the field of view</source>
        <translation>vuele más bajo o estreche el campo de visión</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/frames.py"/>
        <source>height {0:g} m with a field of view of {1:g} deg: the image reaches past the Earth's horizon</source>
        <translation>altura de {0:g} m con un campo de visión de {1:g} grados: la imagen rebasa el horizonte de la Tierra</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>a perspective lens, or a fisheye, whose image is about as far from its centre as a ray is off the axis</source>
        <translation>un objetivo en perspectiva, o un ojo de pez, cuya imagen se aleja del centro más o menos tanto como el rayo se aparta del eje</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>aspect ratio</source>
        <translation>relación de aspecto</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>choose a less extreme field of view or aspect ratio</source>
        <translation>elija un campo de visión o una relación de aspecto menos extremos</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>distortion k1</source>
        <translation>distorsión k1</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>distortion k2</source>
        <translation>distorsión k2</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>distortion k3</source>
        <translation>distorsión k3</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>distortion k4</source>
        <translation>distorsión k4</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>distortion k5</source>
        <translation>distorsión k5</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>distortion k6</source>
        <translation>distorsión k6</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>distortion p1</source>
        <translation>distorsión p1</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>distortion p2</source>
        <translation>distorsión p2</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>field of view</source>
        <translation>campo de visión</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>field of view across the diagonal {0:g} deg: must be between 0 and 180, both excluded</source>
        <translation>campo de visión en diagonal de {0:g} grados: debe estar entre 0 y 180, ambos excluidos</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>field of view across the image's diagonal</source>
        <translation>campo de visión en la diagonal de la imagen</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>fifth radial coefficient of a perspective lens, in the denominator</source>
        <translation>quinto coeficiente radial de un objetivo en perspectiva, en el denominador</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>first radial coefficient of the lens's distortion, as OpenCV defines it</source>
        <translation>primer coeficiente radial de la distorsión del objetivo, como lo define OpenCV</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>first tangential coefficient of a perspective lens</source>
        <translation>primer coeficiente tangencial de un objetivo en perspectiva</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>fisheye</source>
        <translation>ojo de pez</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>focal length {0} mm: must be above 0</source>
        <translation>distancia focal de {0} mm: debe ser mayor que 0</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>fourth radial coefficient; of a perspective lens, in the denominator</source>
        <translation>cuarto coeficiente radial; de un objetivo en perspectiva, en el denominador</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>give the part of the sensor that the image shows</source>
        <translation>dé la parte del sensor que muestra la imagen</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>how far the optical axis meets the image below its centre, as a share of its height</source>
        <translation>cuánto más abajo del centro de la imagen está el eje óptico, como parte de su altura</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>how far the optical axis meets the image right of its centre, as a share of its width</source>
        <translation>cuánto más a la derecha del centro de la imagen está el eje óptico, como parte de su anchura</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>lens</source>
        <translation>objetivo</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>magnification of blue relative to green, minus 1</source>
        <translation>aumento del azul respecto al verde, menos 1</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>magnification of red relative to green, minus 1: 0.001 moves a corner at 400 px outward by 0.4 px</source>
        <translation>aumento del rojo respecto al verde, menos 1: 0.001 desplaza 0.4 px hacia fuera una esquina a 400 px</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>perspective</source>
        <translation>perspectiva</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>principal point, down</source>
        <translation>punto principal, hacia abajo</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>principal point, right</source>
        <translation>punto principal, a la derecha</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>scale of blue</source>
        <translation>escala del azul</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>scale of red</source>
        <translation>escala del rojo</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>second radial coefficient</source>
        <translation>segundo coeficiente radial</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>second tangential coefficient of a perspective lens</source>
        <translation>segundo coeficiente tangencial de un objetivo en perspectiva</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>sensor {0:g} by {1:g} mm and an image of {2:.4g} to 1: pixels would not be square</source>
        <translation>sensor de {0:g} por {1:g} mm e imagen de {2:.4g} a 1: los píxeles no serían cuadrados</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>sensor {0} by {1} mm: both sides must be above 0</source>
        <translation>sensor de {0} por {1} mm: ambos lados deben ser mayores que 0</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>sixth radial coefficient of a perspective lens, in the denominator</source>
        <translation>sexto coeficiente radial de un objetivo en perspectiva, en el denominador</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>third radial coefficient</source>
        <translation>tercer coeficiente radial</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>width of the image over its height</source>
        <translation>anchura de la imagen entre su altura</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/lens.py"/>
        <source>{0} field of view {1} deg: must be between 0 and 180, both excluded</source>
        <translation>campo de visión {0} de {1} grados: debe estar entre 0 y 180, ambos excluidos</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/magnetic.py"/>
        <source>year {0:.1f}: the magnetic field is known from {1:.0f} to {2:.0f}</source>
        <translation>año {0:.1f}: el campo magnético se conoce de {1:.0f} a {2:.0f}</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/mercator.py"/>
        <source>fly lower or farther from the pole</source>
        <translation>vuele más bajo o más lejos del polo</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/mercator.py"/>
        <source>image at latitude {0!r} from {1:g} m: it holds a pole, which Web Mercator does not</source>
        <translation>imagen en la latitud {0!r} desde {1:g} m: contiene un polo, que Web Mercator no tiene</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/mercator.py"/>
        <source>span {0} of the world, size {1} px: both must be above 0</source>
        <translation>tramo {0} del mundo, tamaño {1} px: ambos deben ser mayores que 0</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/mercator.py"/>
        <source>tile size {0} px: must be a multiple of 256</source>
        <translation>tamaño de tesela {0} px: debe ser un múltiplo de 256</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/mercator.py"/>
        <source>zooms {0} to {1}, native {2}: need 0 &lt;= minimum &lt;= native &lt;= maximum &lt;= {3}</source>
        <translation>zooms de {0} a {1}, nativo {2}: hace falta 0 &lt;= mínimo &lt;= nativo &lt;= máximo &lt;= {3}</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/planes.py"/>
        <location filename="../../core/mission/layout/rotated.py"/>
        <source>choose an area that the source shows</source>
        <translation>elija un área que la fuente muestre</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/planes.py"/>
        <source>image at latitude {0!r}, longitude {1!r}: lies beyond what the source's CRS {2} can show</source>
        <translation>imagen en latitud {0!r}, longitud {1!r}: queda fuera de lo que puede mostrar el SRC {2} de la fuente</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/reference.py"/>
        <source>coordinate reference system {0!r}: must be a code such as EPSG:25832, or WKT</source>
        <translation>sistema de referencia de coordenadas {0!r}: debe ser un código como EPSG:25832, o WKT</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/reference.py"/>
        <source>coordinate reference system {0!r}: {1}</source>
        <translation>sistema de referencia de coordenadas {0!r}: {1}</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/reference.py"/>
        <source>coordinate reference system {0}: unit {1!r} of {2:g}: must be greater than 0</source>
        <translation>sistema de referencia de coordenadas {0}: unidad {1!r} de {2:g}: debe ser mayor que 0</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/reference.py"/>
        <source>coordinate reference system: names the file {0}, which is not opened; must be a code such as EPSG:25832, or WKT without files</source>
        <translation>sistema de referencia de coordenadas: nombra el archivo {0}, que no se abre; debe ser un código como EPSG:25832, o WKT sin archivos</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/reference.py"/>
        <source>coordinate reference system: {0} characters: must be no more than {1}</source>
        <translation>sistema de referencia de coordenadas: {0} caracteres: no debe tener más de {1}</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/sun.py"/>
        <source>sun at a height of {0:g} degrees: must be above 0 and at most 90</source>
        <translation>sol a una altura de {0:g} grados: debe ser mayor que 0 y como máximo 90</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/sun.py"/>
        <source>sun at an azimuth of {0:g} degrees: must be -360 to 360</source>
        <translation>sol en un acimut de {0:g} grados: debe estar entre -360 y 360</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/vertical.py"/>
        <source>vertical datum {0!r}: must be {1}, {2}, {3} or the code of a vertical system</source>
        <translation>dátum vertical {0!r}: debe ser {1}, {2}, {3} o el código de un sistema vertical</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/view.py"/>
        <source>fly lower, or choose a source that has lower zooms</source>
        <translation>vuele más bajo o elija una fuente que tenga zooms más bajos</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/view.py"/>
        <source>image of {0:,} x {1:,} px: shows more than {2:,} tiles of the source, which are allowed for one</source>
        <translation>imagen de {0:,} x {1:,} px: muestra más de {2:,} teselas de la fuente, que son las permitidas para una</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/ways.py"/>
        <source>leave room between them, or keep less distance</source>
        <translation>deje espacio entre ellas, o guarde menos distancia</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/ways.py"/>
        <location filename="../../core/mission/flight/path.py"/>
        <source>move it outside</source>
        <translation>muévalo fuera</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/ways.py"/>
        <source>no way leads around the no-fly areas</source>
        <translation>ningún camino rodea las zonas de exclusión</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/ways.py"/>
        <source>the end of a leg</source>
        <translation>el final de un tramo</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/ways.py"/>
        <source>the start of a leg</source>
        <translation>el inicio de un tramo</translation>
    </message>
    <message>
        <location filename="../../core/geodesy/ways.py"/>
        <source>{0}: lies inside a no-fly area</source>
        <translation>{0}: está dentro de una zona de exclusión aérea</translation>
    </message>
    <message>
        <location filename="../../core/imagery/cache/tile_cache.py"/>
        <source>cache of {0} bytes: must be 1 or more</source>
        <translation>caché de {0} bytes: debe ser 1 o más</translation>
    </message>
    <message>
        <location filename="../../core/imagery/cache/tile_cache.py"/>
        <source>cache {0!r}: is not there; {1} holds {2}</source>
        <translation>caché {0!r}: no existe; {1} contiene {2}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/cache/tile_cache.py"/>
        <source>cache {0}: cannot be removed ({1})</source>
        <translation>caché {0}: no se puede borrar ({1})</translation>
    </message>
    <message>
        <location filename="../../core/imagery/cache/tile_cache.py"/>
        <source>leave the cache out for none</source>
        <translation>para no tener ninguna, omitirla</translation>
    </message>
    <message>
        <location filename="../../core/imagery/catalogue.py"/>
        <source> (with {0})</source>
        <translation> (con {0})</translation>
    </message>
    <message>
        <location filename="../../core/imagery/catalogue.py"/>
        <source>catalogue entry {0!r}: must be an object</source>
        <translation>entrada del catálogo {0!r}: debe ser un objeto</translation>
    </message>
    <message>
        <location filename="../../core/imagery/catalogue.py"/>
        <source>catalogue entry {0!r}: must be of kind xyz</source>
        <translation>entrada del catálogo {0!r}: debe ser de clase xyz</translation>
    </message>
    <message>
        <location filename="../../core/imagery/catalogue.py"/>
        <location filename="../../core/mission/cameras.py"/>
        <source>choose another</source>
        <translation>elija otro</translation>
    </message>
    <message>
        <location filename="../../core/imagery/catalogue.py"/>
        <source>choose another, or `terrainav sources remove` it</source>
        <translation>elija otro, o elimínela con `terrainav sources remove`</translation>
    </message>
    <message>
        <location filename="../../core/imagery/catalogue.py"/>
        <source>date {0!r}: the URL has no {{date}} to put it in</source>
        <translation>fecha {0!r}: la URL no tiene {{date}} donde ponerla</translation>
    </message>
    <message>
        <location filename="../../core/imagery/catalogue.py"/>
        <location filename="../../core/mission/cameras.py"/>
        <source>did you mean {0}? </source>
        <translation>¿se quería decir {0}? </translation>
    </message>
    <message>
        <location filename="../../core/imagery/catalogue.py"/>
        <source>source name {0!r}: is one of the catalogue's</source>
        <translation>nombre de fuente {0!r}: es uno de los del catálogo</translation>
    </message>
    <message>
        <location filename="../../core/imagery/catalogue.py"/>
        <source>source name {0!r}: is taken</source>
        <translation>nombre de fuente {0!r}: ya está en uso</translation>
    </message>
    <message>
        <location filename="../../core/imagery/catalogue.py"/>
        <source>source name {0!r}: must be lower-case letters, digits, hyphens and underscores, at most 64</source>
        <translation>nombre de fuente {0!r}: debe constar de minúsculas, cifras, guiones y guiones bajos, 64 como máximo</translation>
    </message>
    <message>
        <location filename="../../core/imagery/catalogue.py"/>
        <source>source {0!r} is unknown: {1}`terrainav sources` lists the names; a file, a URL template with {{z}}, {{x}}, {{y}}, and wmts:URL, wms:URL, arcgis:URL and ogcapi:URL work as well</source>
        <translation>fuente {0!r}: desconocida: {1}`terrainav sources` muestra los nombres; también sirven un archivo, una plantilla de URL con {{z}}, {{x}}, {{y}}, y wmts:URL, wms:URL, arcgis:URL y ogcapi:URL</translation>
    </message>
    <message>
        <location filename="../../core/imagery/catalogue.py"/>
        <source>source {0!r}: is part of the catalogue, which stays as it is</source>
        <translation>fuente {0!r}: es parte del catálogo, que se queda como está</translation>
    </message>
    <message>
        <location filename="../../core/imagery/catalogue.py"/>
        <source>source {0!r}: not one of your own, which are {1}</source>
        <translation>fuente {0!r}: no es ninguna de las propias, que son {1}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/catalogue.py"/>
        <source>source {0!r}: several have this title; name one of {1}</source>
        <translation>fuente {0!r}: varias tienen este título; indique una de {1}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/catalogue.py"/>
        <source>sources</source>
        <translation>fuentes</translation>
    </message>
    <message>
        <location filename="../../core/imagery/decode.py"/>
        <source>JPEG cut off</source>
        <translation>JPEG incompleto</translation>
    </message>
    <message>
        <location filename="../../core/imagery/decode.py"/>
        <source>JPEG of more than {0} scans or {1} segments</source>
        <translation>JPEG de más de {0} barridos o {1} segmentos</translation>
    </message>
    <message>
        <location filename="../../core/imagery/decode.py"/>
        <source>JPEG segments out of step</source>
        <translation>segmentos de JPEG desacompasados</translation>
    </message>
    <message>
        <location filename="../../core/imagery/decode.py"/>
        <source>a WebP image, which libwebp {0} would not read safely: install Pillow 10.0.1 or later</source>
        <translation>una imagen WebP que la libwebp {0} no leería de forma segura: instale Pillow 10.0.1 o posterior</translation>
    </message>
    <message>
        <location filename="../../core/imagery/decode.py"/>
        <source>a WebP image, which this installation of Pillow cannot read</source>
        <translation>una imagen WebP, que esta instalación de Pillow no puede leer</translation>
    </message>
    <message>
        <location filename="../../core/imagery/decode.py"/>
        <source>an empty answer instead of an image</source>
        <translation>una respuesta vacía en lugar de una imagen</translation>
    </message>
    <message>
        <location filename="../../core/imagery/decode.py"/>
        <source>an image of {0}x{1} px instead of {2}x{3}</source>
        <translation>una imagen de {0}x{1} px en lugar de {2}x{3}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/decode.py"/>
        <source>broken image ({0})</source>
        <translation>imagen dañada ({0})</translation>
    </message>
    <message>
        <location filename="../../core/imagery/decode.py"/>
        <source>no imagery (a transparent image)</source>
        <translation>no hay imágenes (una imagen transparente)</translation>
    </message>
    <message>
        <location filename="../../core/imagery/decode.py"/>
        <source>no imagery here, the provider says ({0}: {1})</source>
        <translation>no hay imágenes aquí, según el proveedor ({0}: {1})</translation>
    </message>
    <message>
        <location filename="../../core/imagery/decode.py"/>
        <source>no imagery here: an image of one colour, rgb({0}, {1}, {2})</source>
        <translation>no hay imágenes aquí: una imagen de un solo color, rgb({0}, {1}, {2})</translation>
    </message>
    <message>
        <location filename="../../core/imagery/decode.py"/>
        <source>{0:,} bytes, more than the {1:,} of {2}x{3} px at most</source>
        <translation>{0:,} bytes, más de los {1:,} que puede tener una imagen de {2}x{3} px</translation>
    </message>
    <message>
        <location filename="../../core/imagery/decode.py"/>
        <source>{0} instead of an image</source>
        <translation>{0} en lugar de una imagen</translation>
    </message>
    <message>
        <location filename="../../core/imagery/decode.py"/>
        <source>{0} instead of an image: {1}</source>
        <translation>{0} en lugar de una imagen: {1}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <source> from {0} to {1}</source>
        <translation> de {0} hasta {1}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <source>URLs are for xyz, which needs them</source>
        <translation>las URL son para xyz, que las necesita</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <source>an object</source>
        <translation>un objeto</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <source>as the server takes them</source>
        <translation>como las acepta el servidor</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <source>bounds {0}: must be west, south, east, north in degrees</source>
        <translation>límites {0}: deben ser oeste, sur, este, norte en grados</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <source>catalogue entry {0!r}: wrong or missing: {1}</source>
        <translation>entrada del catálogo {0!r}: erróneo o ausente: {1}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <source>catalogue entry {0!r}: {1}</source>
        <translation>entrada del catálogo {0!r}: {1}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <source>date {0!r}: must be one of those there are, such as {1}</source>
        <translation>fecha {0!r}: debe ser una de las que hay, como {1}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <source>date {0!r}: must be one the server takes</source>
        <translation>fecha {0!r}: debe ser una que acepte el servidor</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <source>date {0!r}: must be {1}, from {2} to {3}</source>
        <translation>fecha {0!r}: debe ser {1}, de {2} hasta {3}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <location filename="../../core/imagery/opening.py"/>
        <source>date {0!r}: {1} has no dates to choose from</source>
        <translation>fecha {0!r}: {1} no tiene fechas que elegir</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <source>dates of kind {0!r}: must be one of {1}</source>
        <translation>fechas de clase {0!r}: debe ser una de {1}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <source>dates of kind {0!r}: values are for listed ones, which need them</source>
        <translation>fechas de clase {0!r}: los valores son para las enumeradas, que los necesitan</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <source>dates of kind {0!r}: values must be text</source>
        <translation>fechas de tipo {0!r}: los valores deben ser texto</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <source>environment variable {0!r}: must be letters, digits and underscores, such as {1}</source>
        <translation>variable de entorno {0!r}: debe constar de letras, cifras y guiones bajos, como {1}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <source>every day</source>
        <translation>cada día</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <source>every year</source>
        <translation>cada año</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <source>kind {0!r}: must be one of {1}</source>
        <translation>clase {0!r}: debe ser una de {1}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <source>needs a title</source>
        <translation>necesita un título</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <source>needs attribution and licence</source>
        <translation>necesita atribución y licencia</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <source>needs terms and terms_url</source>
        <translation>necesita terms y terms_url</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <source>now</source>
        <translation>hoy</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <source>one must be asked for</source>
        <translation>hay que pedir una</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <source>text of one line</source>
        <translation>texto de una línea</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <source>tile size {0} px: must be {1} or less</source>
        <translation>tamaño de tesela {0} px: debe ser {1} o menos</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <source>tile_px []: needs the width of its tiles, such as [256]</source>
        <translation>tile_px []: falta el ancho de las teselas, por ejemplo [256]</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <source>tiles of {0} px: {1} has {2}</source>
        <translation>teselas de {0} px: {1} tiene {2}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <source>whole numbers</source>
        <translation>números enteros</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <location filename="../../core/mission/cameras.py"/>
        <source>{0!r} is unknown; known are {1}</source>
        <translation>{0!r} es desconocido; se conocen {1}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <source>{0} by default</source>
        <translation>{0} por defecto</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <source>{0} from {1} to {2}; {3}</source>
        <translation>{0} de {1} hasta {2}; {3}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <source>{0} is missing</source>
        <translation>falta {0}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <source>{0} with {1!r}: must be {2}</source>
        <translation>{0} con {1!r}: debe ser {2}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <source>{0} {1!r}: must be {2}</source>
        <translation>{0} {1!r}: debe ser {2}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <source>{0}: has imagery of several dates</source>
        <translation>{0}: tiene imágenes de varias fechas</translation>
    </message>
    <message>
        <location filename="../../core/imagery/entry.py"/>
        <source>{date} in a URL needs dates, {key} needs key_env</source>
        <translation>{date} en una URL necesita fechas, {key} necesita key_env</translation>
    </message>
    <message>
        <location filename="../../core/imagery/http/client.py"/>
        <source> (tried {0} times)</source>
        <translation> (intentado {0} veces)</translation>
    </message>
    <message>
        <location filename="../../core/imagery/http/client.py"/>
        <source>ask for less at a time, or resume later</source>
        <translation>pida menos de una vez, o continúe más tarde</translation>
    </message>
    <message>
        <location filename="../../core/imagery/http/client.py"/>
        <location filename="../../core/imagery/http/requests_transport.py"/>
        <location filename="../../terrainav_plugin/network/transport.py"/>
        <location filename="../../terrainav_plugin/network/worker.py"/>
        <source>cancelled while waiting for the network</source>
        <translation>cancelado mientras se esperaba a la red</translation>
    </message>
    <message>
        <location filename="../../core/imagery/http/client.py"/>
        <source>more than {0} redirects</source>
        <translation>más de {0} redirecciones</translation>
    </message>
    <message>
        <location filename="../../core/imagery/http/client.py"/>
        <source>redirect to an address that is neither http nor https</source>
        <translation>redirección a una dirección que no es http ni https</translation>
    </message>
    <message>
        <location filename="../../core/imagery/http/client.py"/>
        <source>redirect to something that is not a URL</source>
        <translation>redirección a algo que no es una URL</translation>
    </message>
    <message>
        <location filename="../../core/imagery/http/client.py"/>
        <source>resume later</source>
        <translation>reanude más tarde</translation>
    </message>
    <message>
        <location filename="../../core/imagery/http/client.py"/>
        <source>{0} refuses: {1}</source>
        <translation>{0} lo rechaza: {1}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/http/client.py"/>
        <source>{0}: not requested, as the last {1} requests had no answer in time</source>
        <translation>{0}: no se ha pedido, porque las últimas {1} peticiones no tuvieron respuesta a tiempo</translation>
    </message>
    <message>
        <location filename="../../core/imagery/http/client.py"/>
        <source>{0}: {1}; it asks to come back in {2:.0f} s: resume then</source>
        <translation>{0}: {1}; pide volver dentro de {2:.0f} s: continúe entonces</translation>
    </message>
    <message>
        <location filename="../../core/imagery/http/requests_transport.py"/>
        <location filename="../../terrainav_plugin/network/answers.py"/>
        <source>connection to {0} was lost</source>
        <translation>se perdió la conexión con {0}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/http/requests_transport.py"/>
        <location filename="../../terrainav_plugin/network/worker.py"/>
        <source>no answer from {0} for {1:g} s</source>
        <translation>sin respuesta de {0} durante {1:g} s</translation>
    </message>
    <message>
        <location filename="../../core/imagery/http/requests_transport.py"/>
        <location filename="../../terrainav_plugin/network/answers.py"/>
        <source>no connection to {0}</source>
        <translation>sin conexión con {0}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/http/requests_transport.py"/>
        <location filename="../../terrainav_plugin/network/answers.py"/>
        <source>no trusted connection to {0} (TLS)</source>
        <translation>sin conexión de confianza con {0} (TLS)</translation>
    </message>
    <message>
        <location filename="../../core/imagery/http/requests_transport.py"/>
        <location filename="../../terrainav_plugin/network/worker.py"/>
        <source>no whole answer within {0:g} s</source>
        <translation>sin respuesta completa en {0:g} s</translation>
    </message>
    <message>
        <location filename="../../core/imagery/http/requests_transport.py"/>
        <location filename="../../terrainav_plugin/network/answers.py"/>
        <location filename="../../terrainav_plugin/network/transport.py"/>
        <location filename="../../terrainav_plugin/network/worker.py"/>
        <source>the URL is not valid</source>
        <translation>la URL no es válida</translation>
    </message>
    <message>
        <location filename="../../core/imagery/http/requests_transport.py"/>
        <location filename="../../terrainav_plugin/network/answers.py"/>
        <source>the proxy does not answer</source>
        <translation>el proxy no responde</translation>
    </message>
    <message>
        <location filename="../../core/imagery/http/transport.py"/>
        <source>a compressed answer that is damaged</source>
        <translation>una respuesta comprimida que está dañada</translation>
    </message>
    <message>
        <location filename="../../core/imagery/http/transport.py"/>
        <source>an answer compressed as {0}, which was not requested</source>
        <translation>una respuesta comprimida como {0}, que no se pidió</translation>
    </message>
    <message>
        <location filename="../../core/imagery/http/transport.py"/>
        <source>an answer cut off after {0} of {1} bytes</source>
        <translation>una respuesta cortada tras {0} de {1} bytes</translation>
    </message>
    <message>
        <location filename="../../core/imagery/http/transport.py"/>
        <source>an answer of more than {0} bytes</source>
        <translation>una respuesta de más de {0} bytes</translation>
    </message>
    <message>
        <location filename="../../core/imagery/http/transport.py"/>
        <source>an answer of more than {0} header lines</source>
        <translation>una respuesta de más de {0} líneas de cabecera</translation>
    </message>
    <message>
        <location filename="../../core/imagery/mbtiles.py"/>
        <source>MBTiles {0}</source>
        <translation>MBTiles {0}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/mbtiles.py"/>
        <source>MBTiles {0}: cannot be read ({1})</source>
        <translation>MBTiles {0}: no se puede leer ({1})</translation>
    </message>
    <message>
        <location filename="../../core/imagery/mbtiles.py"/>
        <source>MBTiles {0}: is not an MBTiles file, or is damaged ({1})</source>
        <translation>MBTiles {0}: no es un archivo MBTiles, o está dañado ({1})</translation>
    </message>
    <message>
        <location filename="../../core/imagery/mbtiles.py"/>
        <source>MBTiles {0}: is not there</source>
        <translation>MBTiles {0}: no existe</translation>
    </message>
    <message>
        <location filename="../../core/imagery/mbtiles.py"/>
        <source>MBTiles {0}: {1}</source>
        <translation>MBTiles {0}: {1}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/mbtiles.py"/>
        <source>give the file an index: CREATE UNIQUE INDEX tile_index ON tiles (zoom_level, tile_column, tile_row)</source>
        <translation>dé al archivo un índice: CREATE UNIQUE INDEX tile_index ON tiles (zoom_level, tile_column, tile_row)</translation>
    </message>
    <message>
        <location filename="../../core/imagery/mbtiles.py"/>
        <source>holds no tiles</source>
        <translation>no contiene teselas</translation>
    </message>
    <message>
        <location filename="../../core/imagery/mbtiles.py"/>
        <source>holds vector tiles (pbf); must hold images (png, jpg or webp)</source>
        <translation>contiene teselas vectoriales (pbf); debe contener imágenes (png, jpg o webp)</translation>
    </message>
    <message>
        <location filename="../../core/imagery/mbtiles.py"/>
        <source>its tiles are no images ({0}); must be png, jpg or webp</source>
        <translation>sus teselas no son imágenes ({0}); deben ser png, jpg o webp</translation>
    </message>
    <message>
        <location filename="../../core/imagery/mbtiles.py"/>
        <source>its tiles are of zooms {0!r} to {1!r}; must be whole numbers</source>
        <translation>sus teselas son de los zooms {0!r} a {1!r}; deben ser números enteros</translation>
    </message>
    <message>
        <location filename="../../core/imagery/mbtiles.py"/>
        <source>its tiles are of {0}x{1} px; must be square, of {2} px at most</source>
        <translation>sus teselas son de {0}x{1} px; deben ser cuadradas, de {2} px como máximo</translation>
    </message>
    <message>
        <location filename="../../core/imagery/mbtiles.py"/>
        <source>the source was closed</source>
        <translation>la fuente se cerró</translation>
    </message>
    <message>
        <location filename="../../core/imagery/mbtiles.py"/>
        <source>{0} is computed; must be a table, or a view that reads tables alone, of {1:,} characters at most</source>
        <translation>{0} se calcula; debe ser una tabla, o una vista que solo lea tablas, de {1:,} caracteres como máximo</translation>
    </message>
    <message>
        <location filename="../../core/imagery/mbtiles.py"/>
        <source>{0}: is not in {1}</source>
        <translation>{0}: no está en {1}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/mbtiles.py"/>
        <source>{0}: takes more than {1:g} s to look a tile up</source>
        <translation>{0}: tarda más de {1:g} s en buscar una tesela</translation>
    </message>
    <message>
        <location filename="../../core/imagery/opening.py"/>
        <source>bands {0}: {1} has red, green and blue alone, as all sources but raster files</source>
        <translation>bandas {0}: {1} solo tiene rojo, verde y azul, como todas las fuentes salvo los archivos ráster</translation>
    </message>
    <message>
        <location filename="../../core/imagery/opening.py"/>
        <source>name a file, a URL template or a name of the catalogue</source>
        <translation>nombre un archivo, una plantilla de URL o un nombre del catálogo</translation>
    </message>
    <message>
        <location filename="../../core/imagery/opening.py"/>
        <source>name one of the sources that have some</source>
        <translation>nombre una de las fuentes que las tienen</translation>
    </message>
    <message>
        <location filename="../../core/imagery/opening.py"/>
        <source>source {0}: a file states no terms</source>
        <translation>fuente {0}: un archivo no indica condiciones</translation>
    </message>
    <message>
        <location filename="../../core/imagery/opening.py"/>
        <source>source {0}: is a map of QGIS and can be captured inside QGIS only</source>
        <translation>fuente {0}: es un mapa de QGIS y solo se puede capturar dentro de QGIS</translation>
    </message>
    <message>
        <location filename="../../core/imagery/opening.py"/>
        <source>stretch {0}: {1} has 8 bits, as all sources but raster files</source>
        <translation>realce {0}: {1} tiene 8 bits, como todas las fuentes salvo los archivos ráster</translation>
    </message>
    <message>
        <location filename="../../core/imagery/opening.py"/>
        <source>sun at {0:.1f} degrees: {1} has the light in which it was taken, and only the synthetic world can be lit</source>
        <translation>sol a {0:.1f} grados: {1} tiene la luz con la que se tomó, y solo se puede iluminar el mundo sintético</translation>
    </message>
    <message>
        <location filename="../../core/imagery/opening.py"/>
        <source>{0} connections: must be 1 or more</source>
        <translation>{0} conexiones: debe ser 1 o más</translation>
    </message>
    <message>
        <location filename="../../core/imagery/opening.py"/>
        <location filename="../../core/imagery/raster/source.py"/>
        <location filename="../../core/imagery/services/service.py"/>
        <source>{0}: needs an API key: set the environment variable {1}</source>
        <translation>{0}: necesita una clave API: defina la variable de entorno {1}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/placeholder.py"/>
        <source>no imagery here: the provider's placeholder image</source>
        <translation>no hay imágenes aquí: la imagen de relleno del proveedor</translation>
    </message>
    <message>
        <location filename="../../core/imagery/placeholder.py"/>
        <source>placeholder {0!r}: must be the SHA-256 of a tile's file, or the first {1} of its digits or more</source>
        <translation>imagen de relleno {0!r}: debe ser el SHA-256 del archivo de una tesela, o sus primeros {1} dígitos o más</translation>
    </message>
    <message>
        <location filename="../../core/imagery/policy.py"/>
        <source>agree to the terms first{0}</source>
        <translation>acepte antes las condiciones{0}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/policy.py"/>
        <source>agreeing to its terms</source>
        <translation>aceptar sus condiciones</translation>
    </message>
    <message>
        <location filename="../../core/imagery/policy.py"/>
        <source>at most {0:,} requests, whatever you agree to</source>
        <translation>{0:,} peticiones como máximo, se acepte lo que se acepte</translation>
    </message>
    <message>
        <location filename="../../core/imagery/policy.py"/>
        <source>breaking its terms</source>
        <translation>infringir sus condiciones</translation>
    </message>
    <message>
        <location filename="../../core/imagery/policy.py"/>
        <source>bulk_allowed {0!r} without max_tiles: say how many are no bulk</source>
        <translation>bulk_allowed {0!r} sin max_tiles: indique cuántas no son masivas</translation>
    </message>
    <message>
        <location filename="../../core/imagery/policy.py"/>
        <source>bulk_allowed {0!r}: must be one of {1}</source>
        <translation>bulk_allowed {0!r}: debe ser uno de {1}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/policy.py"/>
        <source>nothing may be cached</source>
        <translation>no se puede guardar nada en caché</translation>
    </message>
    <message>
        <location filename="../../core/imagery/policy.py"/>
        <source>over {0:,} requests require accepting the terms{1}</source>
        <translation>más de {0:,} peticiones exigen aceptar las condiciones{1}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/policy.py"/>
        <source>sources that allow it: {0}</source>
        <translation>fuentes que lo permiten: {0}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/policy.py"/>
        <location filename="../../core/live/terms.py"/>
        <source>take another source</source>
        <translation>tome otra fuente</translation>
    </message>
    <message>
        <location filename="../../core/imagery/policy.py"/>
        <source>unlimited requests</source>
        <translation>peticiones sin límite</translation>
    </message>
    <message>
        <location filename="../../core/imagery/policy.py"/>
        <source>{0:g} requests/s</source>
        <translation>{0:g} peticiones/s</translation>
    </message>
    <message>
        <location filename="../../core/imagery/policy.py"/>
        <source>{0} connections</source>
        <translation>{0} conexiones</translation>
    </message>
    <message>
        <location filename="../../core/imagery/policy.py"/>
        <source>{0} {1}: must be a number above 0, or left out</source>
        <translation>{0} {1}: debe ser un número mayor que 0, u omitirse</translation>
    </message>
    <message>
        <location filename="../../core/imagery/policy.py"/>
        <source>{0}: {1:,} requests, but at most {2:,} are allowed without {3}: {4}{5}</source>
        <translation>{0}: {1:,} peticiones, pero sin {3} se permiten {2:,} como máximo: {4}{5}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/colours.py"/>
        <source>choose how they become 8 bits{0}, such as percentile, or write GeoTIFF{1}</source>
        <translation>elija cómo pasan a 8 bits{0}, por ejemplo percentile, o escriba GeoTIFF{1}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/colours.py"/>
        <source>its bands ({0}) are neither a grey one nor red, green and blue</source>
        <translation>sus bandas ({0}) no son ni una gris ni rojo, verde y azul</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/colours.py"/>
        <source>its bands are {0}, and not red, green, blue or grey</source>
        <translation>sus bandas son {0}, y no rojo, verde, azul o gris</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/colours.py"/>
        <source>its values are no heights: its first band is {0}, {1}</source>
        <translation>sus valores no son alturas: su primera banda es {0}, {1}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/colours.py"/>
        <source>name so many, or write GeoTIFF{0}</source>
        <translation>nombre esa cantidad, o escriba GeoTIFF{0}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/colours.py"/>
        <source>values of band {0} are {1}, but JPEG and PNG have 8 bits</source>
        <translation>los valores de la banda {0} son {1}, pero JPEG y PNG tienen 8 bits</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/colours.py"/>
        <source>values of band {0} are {1}: must be one of {2}, as gdal_translate -ot Float32 makes them</source>
        <translation>los valores de la banda {0} son {1}: deben ser uno de {2}, como los hace gdal_translate -ot Float32</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/colours.py"/>
        <source>{0} bands: JPEG and PNG have one or three</source>
        <translation>{0} bandas: JPEG y PNG tienen una o tres</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/colours.py"/>
        <source>{0} bands: must be from 1 to {1}</source>
        <translation>{0} bandas: deben ser de 1 a {1}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/georeference.py"/>
        <source>it does not say where its pixels lie: it has no geotransform and no world file</source>
        <translation>no dice dónde están sus píxeles: no tiene geotransformación ni archivo world</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/georeference.py"/>
        <source>it states no coordinate reference system: say which, for example with gdal_edit.py -a_srs EPSG:32632</source>
        <translation>no indica ningún sistema de referencia de coordenadas: diga cuál, por ejemplo con gdal_edit.py -a_srs EPSG:32632</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/georeference.py"/>
        <source>its centre does not lie on the Web-Mercator map</source>
        <translation>su centro no está en el mapa Web Mercator</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/georeference.py"/>
        <source>its centre lies beyond what {0} reaches</source>
        <translation>su centro queda fuera del alcance de {0}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/georeference.py"/>
        <source>its coordinate reference system, {0}, is not one of maps: say which, for example with gdal_edit.py -a_srs EPSG:32632</source>
        <translation>su sistema de referencia de coordenadas, {0}, no es de mapas: diga cuál, por ejemplo con gdal_edit.py -a_srs EPSG:32632</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/georeference.py"/>
        <source>its geotransform {0} places no pixel</source>
        <translation>su geotransformación {0} no sitúa ningún píxel</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/georeference.py"/>
        <source>its pixels are as wide as the whole map, or have no width there</source>
        <translation>sus píxeles son tan anchos como todo el mapa, o no tienen anchura en él</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/georeference.py"/>
        <source>only ground control points place it: make a map of it first, with gdalwarp</source>
        <translation>solo lo sitúan puntos de control: haga antes un mapa con él, con gdalwarp</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/reading.py"/>
        <source>its header cannot be read whole</source>
        <translation>su cabecera no se puede leer entera</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/reading.py"/>
        <source>no format that GDAL knows</source>
        <translation>ningún formato que GDAL conozca</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/reading.py"/>
        <location filename="../../core/imagery/services/arcgis.py"/>
        <location filename="../../terrainav_plugin/dataset/mosaic.py"/>
        <location filename="../../terrainav_plugin/dataset/rectify.py"/>
        <location filename="../../terrainav_plugin/qgis_source/renderer.py"/>
        <source>no reason given</source>
        <translation>no se indica el motivo</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/reading.py"/>
        <source>no values</source>
        <translation>sin valores</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/reading.py"/>
        <source>raster files need rasterio: pip install terrainav[raster]</source>
        <translation>los archivos ráster necesitan rasterio: pip install terrainav[raster]</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/reading.py"/>
        <source>{0}: closed</source>
        <translation>{0}: cerrado</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/remote.py"/>
        <source>name a copy of it on this machine</source>
        <translation>nombre una copia de él en este equipo</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/remote.py"/>
        <location filename="../../core/imagery/raster/source.py"/>
        <source>start anew</source>
        <translation>empiece de nuevo</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/remote.py"/>
        <location filename="../../core/imagery/raster/source.py"/>
        <source>{0}: has changed since it was opened</source>
        <translation>{0}: ha cambiado desde que se abrió</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/remote.py"/>
        <location filename="../../core/imagery/raster/source.py"/>
        <source>{0}: is gone</source>
        <translation>{0}: ya no existe</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/remote.py"/>
        <source>{0}: its server sends whole files only, and a raster is read in parts (HTTP Range)</source>
        <translation>{0}: su servidor solo envía archivos enteros, y un ráster se lee por partes (HTTP Range)</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/sizes.py"/>
        <source>has {0:,} bands: must be at most {1:,}</source>
        <translation>tiene {0:,} bandas: deben ser como máximo {1:,}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/sizes.py"/>
        <source>has {0:,} overviews: must be at most {1:,}</source>
        <translation>tiene {0:,} vistas generales: deben ser como máximo {1:,}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/sizes.py"/>
        <source>is decoded in blocks of {0:,}x{1:,} px, {2:,.0f} MB each: must be at most {3:,} MB</source>
        <translation>se descodifica en bloques de {0:,}x{1:,} px, de {2:,.0f} MB cada uno: deben ser como máximo {3:,} MB</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/sizes.py"/>
        <source>make a copy in tiles, with gdal_translate -co TILED=YES</source>
        <translation>haga una copia en teselas, con gdal_translate -co TILED=YES</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/sizes.py"/>
        <source>make a copy of its first image, with gdal_translate</source>
        <translation>haga una copia de su primera imagen, con gdal_translate</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/sizes.py"/>
        <source>make a copy of those that you need, with gdal_translate -b</source>
        <translation>haga una copia con las que necesita, con gdal_translate -b</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/sizes.py"/>
        <source>make a copy without them, with gdal_translate</source>
        <translation>haga una copia sin ellas, con gdal_translate</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/sizes.py"/>
        <source>{0} has more than {1:,} directories</source>
        <translation>{0} tiene más de {1:,} directorios</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/sizes.py"/>
        <source>{0} has numbers in place of the text of tag {1}</source>
        <translation>{0} tiene números en lugar del texto de la etiqueta {1}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/sizes.py"/>
        <source>{0} has {1:,} ground control points: must be at most {2:,}</source>
        <translation>{0} tiene {1:,} puntos de control sobre el terreno: deben ser como máximo {2:,}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/sizes.py"/>
        <source>{0} holds more than {1:g} MB of metadata</source>
        <translation>{0} contiene más de {1:g} MB de metadatos</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/source.py"/>
        <source>date {0!r}: must be YYYY-MM-DD, YYYY-MM or YYYY</source>
        <translation>fecha {0!r}: debe ser AAAA-MM-DD, AAAA-MM o AAAA</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/source.py"/>
        <source>give it overviews, with gdaladdo</source>
        <translation>dele vistas generales, con gdaladdo</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/source.py"/>
        <source>is not a raster itself</source>
        <translation>no es él mismo un ráster</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/source.py"/>
        <source>name a raster file</source>
        <translation>nombre un archivo ráster</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/source.py"/>
        <source>name one of those within, such as {0}</source>
        <translation>nombre uno de los que contiene, como {0}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/source.py"/>
        <source>say which date</source>
        <translation>indique qué fecha</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/source.py"/>
        <source>there is none of {0}</source>
        <translation>no hay ninguna de {0}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/source.py"/>
        <source>{0} earlier ones and {1}</source>
        <translation>{0} anteriores y {1}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/source.py"/>
        <source>{0}: a part of zoom {1} covers {2}x{3} px of it, which are too many</source>
        <translation>{0}: una parte del zoom {1} cubre {2}x{3} px de él, que son demasiados</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/source.py"/>
        <source>{0}: cannot be read here: {1}</source>
        <translation>{0}: no se puede leer aquí: {1}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/source.py"/>
        <source>{0}: is a folder</source>
        <translation>{0}: es una carpeta</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/source.py"/>
        <source>{0}: is not a readable raster: {1}</source>
        <translation>{0}: no es un ráster que se pueda leer: {1}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/source.py"/>
        <source>{0}: say which date</source>
        <translation>{0}: indique qué fecha</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/source.py"/>
        <source>{0}: there is no such file</source>
        <translation>{0}: no existe tal archivo</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/source.py"/>
        <source>{0}: {1}; dates there are: {2}</source>
        <translation>{0}: {1}; las fechas que hay son: {2}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/trust.py"/>
        <source>address of a raster file</source>
        <translation>dirección de un archivo ráster</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/trust.py"/>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>bands</source>
        <translation>bandas</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/trust.py"/>
        <source>ground control points</source>
        <translation>puntos de control sobre el terreno</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/trust.py"/>
        <source>has a box without an end beside its pixels</source>
        <translation>tiene una caja sin fin además de sus píxeles</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/trust.py"/>
        <source>has more than {0:,} boxes, or more than {1} MB beside its pixels</source>
        <translation>tiene más de {0:,} cajas, o más de {1} MB además de sus píxeles</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/trust.py"/>
        <source>header</source>
        <translation>cabecera</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/trust.py"/>
        <source>is of a format that is read from folders of this machine alone</source>
        <translation>es de un formato que solo se lee de carpetas de este equipo</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/trust.py"/>
        <source>items of metadata</source>
        <translation>elementos de metadatos</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/trust.py"/>
        <source>make one raster of it, with gdal_translate</source>
        <translation>haga un solo ráster de él, con gdal_translate</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/trust.py"/>
        <source>name a copy of it, unpacked and on this machine</source>
        <translation>indique una copia descomprimida en este equipo</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/trust.py"/>
        <source>name the service itself: wms:URL, wmts:URL or a URL template</source>
        <translation>nombre el servicio mismo: wms:URL, wmts:URL o una plantilla de URL</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/trust.py"/>
        <source>names a place in the file: must name a directory by its number, GTIFF_DIR:2:…</source>
        <translation>indica un lugar en el archivo: debe indicar un directorio por su número, GTIFF_DIR:2:…</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/trust.py"/>
        <source>names another file for its overviews, which is not read</source>
        <translation>nombra otro archivo para sus vistas generales, que no se lee</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/trust.py"/>
        <source>overviews of a band</source>
        <translation>vistas generales de una banda</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/trust.py"/>
        <source>raster file /vsi…: holds credentials; no credentials may stand in it</source>
        <translation>archivo ráster /vsi…: contiene credenciales; no puede haberlas en él</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/trust.py"/>
        <source>reads {0} within more than {1} others</source>
        <translation>lee {0} dentro de más de {1} archivos</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/trust.py"/>
        <source>set {0}={1} if that is right</source>
        <translation>defina {0}={1} si es correcto</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/trust.py"/>
        <source>{0} describes a service or a collection, whose requests keep to no terms</source>
        <translation>{0} describe un servicio o una colección, cuyas peticiones no respetan ninguna condición</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/trust.py"/>
        <source>{0} has {1:,} {2} or more: must be at most {3:,}</source>
        <translation>{0} tiene {1:,} {2} o más: deben ser como máximo {3:,}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/trust.py"/>
        <source>{0} holds more than {1} MB of metadata</source>
        <translation>{0} contiene más de {1} MB de metadatos</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/trust.py"/>
        <source>{0} is of no format of images that a VRT may read here</source>
        <translation>{0} no es de ningún formato de imagen que un VRT pueda leer aquí</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/trust.py"/>
        <source>{0} names other files, which are not read</source>
        <translation>{0} nombra otros archivos, que no se leen</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/trust.py"/>
        <source>{0} reads files more than {1:,} times</source>
        <translation>{0} lee archivos más de {1:,} veces</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/trust.py"/>
        <source>{0} reads {1!r}, which is not a file beside it</source>
        <translation>{0} lee {1!r}, que no es un archivo junto a él</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/trust.py"/>
        <source>{0} reads {1}, which is not a regular file</source>
        <translation>{0} lee {1}, que no es un archivo normal</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/trust.py"/>
        <source>{0} reads {1}, which is not beside it</source>
        <translation>{0} lee {1}, que no está junto a él</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/trust.py"/>
        <source>{0}: has a document type, which GDAL writes none of</source>
        <translation>{0}: tiene un tipo de documento, y GDAL no escribe ninguno</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/trust.py"/>
        <source>{0}: has a view in place of its coordinate reference systems</source>
        <translation>{0}: tiene una vista en lugar de sus sistemas de referencia de coordenadas</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/trust.py"/>
        <source>{0}: is a VRT of more than {1:,} elements, or of more than {2:,} within each other</source>
        <translation>{0}: es un VRT de más de {1:,} elementos, o de más de {2:,} unos dentro de otros</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/trust.py"/>
        <source>{0}: is a VRT of more than {1} MB</source>
        <translation>{0}: es un VRT de más de {1} MB</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/trust.py"/>
        <source>{0}: is a VRT that cannot be read ({1})</source>
        <translation>{0}: es un VRT que no se puede leer ({1})</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/trust.py"/>
        <source>{0}: is a VRT with more in it than bands of files</source>
        <translation>{0}: es un VRT que contiene algo más que bandas de archivos</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/trust.py"/>
        <source>{0}: is not a regular file, and lies beside {1}</source>
        <translation>{0}: no es un archivo normal y está junto a {1}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/raster/trust.py"/>
        <source>{0}: its coordinate reference system names the file {1}, which is not opened; must be a code such as EPSG:25832, or WKT without files</source>
        <translation>{0}: su sistema de referencia de coordenadas nombra el archivo {1}, que no se abre; debe ser un código como EPSG:25832, o WKT sin archivos</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/arcgis.py"/>
        <location filename="../../core/imagery/services/ogcapi.py"/>
        <source>description</source>
        <translation>descripción</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/arcgis.py"/>
        <source>every projected system of EPSG</source>
        <translation>todo sistema proyectado de EPSG</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/arcgis.py"/>
        <source>it neither has tiles nor draws maps in this system: it offers {0}</source>
        <translation>ni tiene teselas ni dibuja mapas en este sistema: ofrece {0}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/arcgis.py"/>
        <source>neither a map service nor an image service, nor a list of them</source>
        <translation>no es un servicio de mapas ni de imágenes, ni una lista de ellos</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/arcgis.py"/>
        <source>refused ({0})</source>
        <translation>rechazado ({0})</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/capabilities.py"/>
        <source>address of a {0}</source>
        <translation>dirección de un servicio {0}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/capabilities.py"/>
        <source>capabilities</source>
        <translation>capacidades</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/capabilities.py"/>
        <source>capabilities of more than {0} bytes</source>
        <translation>descripción del servicio de más de {0} bytes</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/capabilities.py"/>
        <source>capabilities that cannot be read ({0}: {1})</source>
        <translation>capacidades que no se pueden leer ({0}: {1})</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/capabilities.py"/>
        <source>capabilities that cannot be read: {0}</source>
        <translation>la descripción del servicio no se puede leer: {0}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/capabilities.py"/>
        <source>choice {0!r} of a {1}: must be one of {2}</source>
        <translation>elección {0!r} de un {1}: debe ser uno de {2}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/capabilities.py"/>
        <source>it offers none</source>
        <translation>no ofrece ninguno</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/capabilities.py"/>
        <source>no capabilities at this address{0}</source>
        <translation>no hay capacidades en esta dirección{0}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/capabilities.py"/>
        <source>no format</source>
        <translation>ningún formato</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/capabilities.py"/>
        <source>offers {0}, and none of {1}</source>
        <translation>ofrece {0}, y ninguno de {1}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/capabilities.py"/>
        <source>source {0}:{1}: needs OWSLib: pip install owslib</source>
        <translation>fuente {0}:{1}: necesita OWSLib: pip install owslib</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/capabilities.py"/>
        <source>the capabilities at this address are of a {0}: write {1}:URL</source>
        <translation>las capacidades de esta dirección son de un {0}: escriba {1}:URL</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/capabilities.py"/>
        <location filename="../../core/imagery/systems.py"/>
        <source>{0} and {1} more</source>
        <translation>{0} y {1} más</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/capabilities.py"/>
        <source>{0} of {1}: say which with #{2}=…: {3}; `terrainav sources show` lists them</source>
        <translation>{0} de {1}: diga cuál con #{2}=…: {3}; `terrainav sources show` los enumera</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/capabilities.py"/>
        <source>{0} of {1}: {2}</source>
        <translation>{0} de {1}: {2}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/capabilities.py"/>
        <source>{0} {1!r}: {2} offers {3}</source>
        <translation>{0} {1!r}: {2} ofrece {3}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/detecting.py"/>
        <location filename="../../core/storage/stores.py"/>
        <source>address</source>
        <translation>dirección</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/detecting.py"/>
        <source>{0}: no service known here answers{1}; needs a WMTS, WMS, ArcGIS REST service or OGC API, or a URL template</source>
        <translation>{0}: no responde ningún servicio conocido{1}; se necesita un servicio WMTS, WMS o ArcGIS REST, una OGC API o una plantilla de URL</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/json_service.py"/>
        <source>JSON that cannot be read: {0}</source>
        <translation>JSON que no se puede leer: {0}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/json_service.py"/>
        <source>JSON that does not describe a service</source>
        <translation>JSON que no describe un servicio</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/json_service.py"/>
        <source>a description of more than {0} MB</source>
        <translation>una descripción de más de {0} MB</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/json_service.py"/>
        <source>no description in JSON at this address{0}</source>
        <translation>no hay ninguna descripción en JSON en esta dirección{0}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/matrices.py"/>
        <location filename="../../core/imagery/services/ogc.py"/>
        <source>layer {0!r} of {1}</source>
        <translation>capa {0!r} de {1}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/matrices.py"/>
        <source>layer {0!r} of {1}: has tiles in {2} only; needs a Web-Mercator quad, such as WebMercatorQuad or GoogleMapsCompatible, or a projected system of EPSG, with square tiles of 256 px or a multiple</source>
        <translation>capa {0!r} de {1}: solo tiene teselas en {2}; hace falta una cuadrícula Web Mercator, como WebMercatorQuad o GoogleMapsCompatible, o un sistema proyectado de EPSG, con teselas cuadradas de 256 px o un múltiplo</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/ogc.py"/>
        <source>layer {0!r} of {1}: is offered in {2}; needs {3} or another projected system of EPSG</source>
        <translation>capa {0!r} de {1}: se ofrece en {2}; hace falta {3} u otro sistema proyectado de EPSG</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/ogc.py"/>
        <source>speaks version {0}; must be {1}</source>
        <translation>habla la versión {0}; debe ser {1}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/ogc.py"/>
        <source>styles {0!r}: must be one for each of {1} layers</source>
        <translation>estilos {0!r}: debe ser uno para cada una de {1} capas</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/ogcapi.py"/>
        <source>a tile matrix set without matrices that can be used</source>
        <translation>un conjunto de matrices de teselas sin matrices utilizables</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/ogcapi.py"/>
        <source>a tileset without a link to its tiles</source>
        <translation>un conjunto de teselas sin enlace a sus teselas</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/ogcapi.py"/>
        <source>address in a description of {0}</source>
        <translation>dirección en una descripción de {0}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/ogcapi.py"/>
        <source>description of tiles</source>
        <translation>descripción de las teselas</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/ogcapi.py"/>
        <source>links to descriptions and no tiles, {0} deep</source>
        <translation>enlaces a descripciones y ninguna tesela, hasta {0} niveles</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/ogcapi.py"/>
        <source>offers no tiles of images: nothing links to tilesets-map</source>
        <translation>no ofrece teselas de imágenes: nada enlaza con tilesets-map</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/ogcapi.py"/>
        <source>offers tiles of data, and none of images</source>
        <translation>ofrece teselas de datos y ninguna de imágenes</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/ogcapi.py"/>
        <source>tile matrix set</source>
        <translation>conjunto de matrices de teselas</translation>
    </message>
    <message>
        <location filename="../../core/imagery/services/ogcapi.py"/>
        <source>tiles of {0}, which it does not describe</source>
        <translation>teselas de {0}, que no describe</translation>
    </message>
    <message>
        <location filename="../../core/imagery/staticmap.py"/>
        <source>URL signing secret: is not URL-safe base64, as the Google Cloud console shows it</source>
        <translation>secreto de firma de URL: no es base64 para URL, como lo muestra la consola de Google Cloud</translation>
    </message>
    <message>
        <location filename="../../core/imagery/staticmap.py"/>
        <source>image at {0},{1} zoom {2}</source>
        <translation>imagen en {0},{1} zoom {2}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/staticmap.py"/>
        <source>image of {0}x{1} px: {2} gives up to {3} px times {4}</source>
        <translation>imagen de {0}x{1} px: {2} da hasta {3} px por {4}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/staticmap.py"/>
        <source>plan with this source's grid</source>
        <translation>planifique con la cuadrícula de esta fuente</translation>
    </message>
    <message>
        <location filename="../../core/imagery/staticmap.py"/>
        <source>scale {0}: Static Maps has 1 (tiles of 256 px) and 2 (512 px)</source>
        <translation>escala {0}: Static Maps tiene 1 (teselas de 256 px) y 2 (512 px)</translation>
    </message>
    <message>
        <location filename="../../core/imagery/staticmap.py"/>
        <source>{0}: its centre {1!r} has more than {2} decimals, which {3} drops</source>
        <translation>{0}: su centro {1!r} tiene más de {2} decimales, que {3} descarta</translation>
    </message>
    <message>
        <location filename="../../core/imagery/systems.py"/>
        <source>coordinate reference system {0}: {1} has {2}</source>
        <translation>sistema de referencia de coordenadas {0}: {1} tiene {2}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/systems.py"/>
        <source>plane of {0!r}: must be that of a projected system, such as EPSG:2056</source>
        <translation>plano de {0!r}: debe ser el de un sistema proyectado, como EPSG:2056</translation>
    </message>
    <message>
        <location filename="../../core/imagery/systems.py"/>
        <source>plane {0}: must be crs, and west, north, width and height as numbers</source>
        <translation>plano {0}: debe tener crs, y west, north, width y height como números</translation>
    </message>
    <message>
        <location filename="../../core/imagery/tiles.py"/>
        <source>URL template</source>
        <translation>plantilla de URL</translation>
    </message>
    <message>
        <location filename="../../core/imagery/tiles.py"/>
        <source>URL template with subdomains {0}-{1}: the first comes after the last</source>
        <translation>plantilla de URL con subdominios {0}-{1}: el primero va después del último</translation>
    </message>
    <message>
        <location filename="../../core/imagery/tiles.py"/>
        <source>URL template {0}: an unmatched brace</source>
        <translation>plantilla de URL {0}: una llave sin su pareja</translation>
    </message>
    <message>
        <location filename="../../core/imagery/tiles.py"/>
        <source>URL template {0}: without {1}; needs {{z}}, {{x}} and {{y}} (or {{-y}}, or {{q}} or {{{2}}} alone)</source>
        <translation>plantilla de URL {0}: sin {1}; necesita {{z}}, {{x}} e {{y}} (o {{-y}}, o solo {{q}} o {{{2}}})</translation>
    </message>
    <message>
        <location filename="../../core/imagery/tiles.py"/>
        <source>URL template {0}: {1} in its host; a key goes to a host that is written out</source>
        <translation>plantilla de URL {0}: {1} en su servidor; una clave solo va a un servidor escrito por completo</translation>
    </message>
    <message>
        <location filename="../../core/imagery/tiles.py"/>
        <source>URL template {0}: {{s}} without subdomains to put there</source>
        <translation>plantilla de URL {0}: {{s}} sin subdominios que poner</translation>
    </message>
    <message>
        <location filename="../../core/imagery/tiles.py"/>
        <source>URL template {0}: {{{1}}} is for {2}</source>
        <translation>plantilla de URL {0}: {{{1}}} es para {2}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/tiles.py"/>
        <source>URL template {0}: {{{1}}} is unknown; known are {2}</source>
        <translation>plantilla de URL {0}: {{{1}}} es desconocido; se conocen {2}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/tiles.py"/>
        <source>a source that states a plane</source>
        <translation>una fuente con un plano propio</translation>
    </message>
    <message>
        <location filename="../../core/imagery/tiles.py"/>
        <source>no</source>
        <translation>ningún</translation>
    </message>
    <message>
        <location filename="../../core/imagery/tiles.py"/>
        <source>set {0}={1} if the key is for it</source>
        <translation>defina {0}={1} si la clave es para él</translation>
    </message>
    <message>
        <location filename="../../core/imagery/tiles.py"/>
        <source>tile {0}/{1}/{2}</source>
        <translation>tesela {0}/{1}/{2}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/tiles.py"/>
        <source>tiles of the Web-Mercator map</source>
        <translation>teselas del mapa Web Mercator</translation>
    </message>
    <message>
        <location filename="../../core/imagery/tiles.py"/>
        <source>write {0}={{key}} and set TERRAINAV_KEY</source>
        <translation>escriba {0}={{key}} y defina TERRAINAV_KEY</translation>
    </message>
    <message>
        <location filename="../../core/imagery/tiles.py"/>
        <source>zoom {0}: {1} has {2} to {3}</source>
        <translation>zoom {0}: {1} tiene de {2} a {3}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/tiles.py"/>
        <source>{0} for {1}: holds a key in {2!r}, which would end up in files</source>
        <translation>{0} de {1}: contiene una clave en {2!r}, que acabaría en archivos</translation>
    </message>
    <message>
        <location filename="../../core/imagery/tiles.py"/>
        <source>{0} for {1}: holds a user name; no credentials may stand in it</source>
        <translation>{0} de {1}: contiene un nombre de usuario; no puede llevar credenciales</translation>
    </message>
    <message>
        <location filename="../../core/imagery/tiles.py"/>
        <source>{0} of an invalid host or port: must be as in https://tiles.example:8080/</source>
        <translation>{0} con un servidor o puerto no válido: debe ser como en https://tiles.example:8080/</translation>
    </message>
    <message>
        <location filename="../../core/imagery/tiles.py"/>
        <source>{0} of {1} scheme: must start with http:// or https://</source>
        <translation>{0} con esquema {1}: debe empezar por http:// o https://</translation>
    </message>
    <message>
        <location filename="../../core/imagery/tiles.py"/>
        <source>{0} with spaces or control characters: must have none, or spaces written as %20</source>
        <translation>{0} con espacios o caracteres de control: no debe tenerlos, o los espacios deben escribirse como %20</translation>
    </message>
    <message>
        <location filename="../../core/imagery/tiles.py"/>
        <source>{0}: beyond the edge of the map</source>
        <translation>{0}: más allá del borde del mapa</translation>
    </message>
    <message>
        <location filename="../../core/imagery/tiles.py"/>
        <source>{0}: is not a tile of {1} px</source>
        <translation>{0}: no es una tesela de {1} px</translation>
    </message>
    <message>
        <location filename="../../core/imagery/tiles.py"/>
        <source>{0}: {1} is not sent there, because a file names this host and not you</source>
        <translation>{0}: {1} no se envía allí, porque este servidor lo nombra un archivo y no usted</translation>
    </message>
    <message>
        <location filename="../../core/imagery/xyz.py"/>
        <source>say which</source>
        <translation>indique cuál</translation>
    </message>
    <message>
        <location filename="../../core/imagery/xyz.py"/>
        <source>source without a URL template: needs one</source>
        <translation>fuente sin plantilla de URL: necesita una</translation>
    </message>
    <message>
        <location filename="../../core/imagery/xyz.py"/>
        <source>source {0}: its URL has a {{date}}</source>
        <translation>fuente {0}: su URL tiene una {{date}}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/xyz.py"/>
        <source>write #tilesize={0} behind its address</source>
        <translation>escriba #tilesize={0} detrás de su dirección</translation>
    </message>
    <message>
        <location filename="../../core/imagery/xyz.py"/>
        <source>{0}: beyond the tiles of {1}</source>
        <translation>{0}: fuera de las teselas de {1}</translation>
    </message>
    <message>
        <location filename="../../core/imagery/xyz.py"/>
        <source>{0}: needs an API key, and none is set</source>
        <translation>{0}: necesita una clave API, y no hay ninguna definida</translation>
    </message>
    <message>
        <location filename="../../core/labels/classes.py"/>
        <source>background {0!r} and ignore {1!r} must be {2} and {3}</source>
        <translation>background {0!r} e ignore {1!r} deben ser {2} y {3}</translation>
    </message>
    <message>
        <location filename="../../core/labels/classes.py"/>
        <location filename="../../core/vectors/layer.py"/>
        <source>choose a field with fewer values, or none and tell features apart by the product instances</source>
        <translation>elija un campo con menos valores, o ninguno y distinga los objetos por el producto instances</translation>
    </message>
    <message>
        <location filename="../../core/labels/classes.py"/>
        <source>choose another field, or none</source>
        <translation>elija otro campo, o ninguno</translation>
    </message>
    <message>
        <location filename="../../core/labels/classes.py"/>
        <source>color {0!r}: must be #rrggbb</source>
        <translation>color {0!r}: debe ser #rrggbb</translation>
    </message>
    <message>
        <location filename="../../core/labels/classes.py"/>
        <source>id {0!r}: must be a whole number from 0 to {1}</source>
        <translation>id {0!r}: debe ser un número entero de 0 a {1}</translation>
    </message>
    <message>
        <location filename="../../core/labels/classes.py"/>
        <source>it must hold a list named classes</source>
        <translation>debe contener una lista llamada classes</translation>
    </message>
    <message>
        <location filename="../../core/labels/classes.py"/>
        <source>it must hold background, ignore, and classes of id, name and color</source>
        <translation>debe contener background, ignore y classes con id, name y color</translation>
    </message>
    <message>
        <location filename="../../core/labels/classes.py"/>
        <source>labels of {0:,} classes: files of 16 bits hold {1:,}</source>
        <translation>etiquetas de {0:,} clases: los archivos de 16 bits admiten {1:,}</translation>
    </message>
    <message>
        <location filename="../../core/labels/classes.py"/>
        <source>labels {0}: the field {1} has no value in any feature</source>
        <translation>etiquetas {0}: el campo {1} no tiene valor en ningún objeto</translation>
    </message>
    <message>
        <location filename="../../core/labels/classes.py"/>
        <source>name {0!r}: must be a text</source>
        <translation>nombre {0!r}: debe ser un texto</translation>
    </message>
    <message>
        <location filename="../../core/labels/classes.py"/>
        <source>table of classes {0}: {1}</source>
        <translation>tabla de clases {0}: {1}</translation>
    </message>
    <message>
        <location filename="../../core/labels/label_map.py"/>
        <source>choose a field of numbers</source>
        <translation>elija un campo de números</translation>
    </message>
    <message>
        <location filename="../../core/labels/label_map.py"/>
        <source>label order {0!r}: no layer of labels has this field</source>
        <translation>orden de etiquetas {0!r}: ninguna capa de etiquetas tiene este campo</translation>
    </message>
    <message>
        <location filename="../../core/labels/label_map.py"/>
        <source>label order {0}: has the value {1!r}, which is no number</source>
        <translation>orden de etiquetas {0}: tiene el valor {1!r}, que no es un número</translation>
    </message>
    <message>
        <location filename="../../core/live/airsim.py"/>
        <source>camera {0!r}: must be one of {1}</source>
        <translation>cámara {0!r}: debe ser una de {1}</translation>
    </message>
    <message>
        <location filename="../../core/live/airsim.py"/>
        <source>image type {0}: has no floating point values, and depth 1 or 2 have</source>
        <translation>tipo de imagen {0}: no tiene valores de coma flotante; los tienen las profundidades 1 y 2</translation>
    </message>
    <message>
        <location filename="../../core/live/airsim.py"/>
        <source>image type {0}: must be scene 0, depth 1 or 2, segmentation 5 (with labels), or normals 6</source>
        <translation>tipo de imagen {0}: debe ser escena 0, profundidad 1 o 2, segmentación 5 (con etiquetas) o normales 6</translation>
    </message>
    <message>
        <location filename="../../core/live/airsim.py"/>
        <source>method {0!r}: is none of a camera's: {1}</source>
        <translation>método {0!r}: no es ninguno de los de una cámara: {1}</translation>
    </message>
    <message>
        <location filename="../../core/live/airsim.py"/>
        <source>method {0!r}: takes other parameters ({1})</source>
        <translation>método {0!r}: toma otros parámetros ({1})</translation>
    </message>
    <message>
        <location filename="../../core/live/airsim.py"/>
        <source>pose: must have position and orientation with numbers</source>
        <translation>pose: debe tener posición y orientación con números</translation>
    </message>
    <message>
        <location filename="../../core/live/airsim.py"/>
        <source>pose: position and orientation must be finite, and the quaternion not zero</source>
        <translation>pose: la posición y la orientación deben ser finitas, y el cuaternión no nulo</translation>
    </message>
    <message>
        <location filename="../../core/live/airsim.py"/>
        <source>request: {0} is missing or no {1}</source>
        <translation>petición: falta {0} o no es {1}</translation>
    </message>
    <message>
        <location filename="../../core/live/airsim.py"/>
        <source>requests: must be a list of 1 to {0} images</source>
        <translation>peticiones: debe ser una lista de 1 a {0} imágenes</translation>
    </message>
    <message>
        <location filename="../../core/live/camera.py"/>
        <source>choose camera</source>
        <translation>elija camera</translation>
    </message>
    <message>
        <location filename="../../core/live/camera.py"/>
        <source>frame {0}: a live camera sees perspectives</source>
        <translation>marco {0}: una cámara en vivo ve perspectivas</translation>
    </message>
    <message>
        <location filename="../../core/live/encoding.py"/>
        <source>choose tif</source>
        <translation>elija tif</translation>
    </message>
    <message>
        <location filename="../../core/live/encoding.py"/>
        <source>format {0}: cannot hold {1}</source>
        <translation>formato {0}: no puede contener {1}</translation>
    </message>
    <message>
        <location filename="../../core/live/encoding.py"/>
        <source>image {0!r}: this frame has {1}</source>
        <translation>imagen {0!r}: este fotograma tiene {1}</translation>
    </message>
    <message>
        <location filename="../../core/live/following.py"/>
        <source>pose at {0:.3f} s: none is known for {1:g} s</source>
        <translation>pose a los {0:.3f} s: no se conoce ninguna durante {1:g} s</translation>
    </message>
    <message>
        <location filename="../../core/live/following.py"/>
        <source>pose at {0:.3f} s: none is known that early</source>
        <translation>pose a los {0:.3f} s: no se conoce ninguna tan temprana</translation>
    </message>
    <message>
        <location filename="../../core/live/following.py"/>
        <source>pose at {0:.3f} s: the last known one is of {1:.3f} s</source>
        <translation>pose a los {0:.3f} s: la última conocida es de los {1:.3f} s</translation>
    </message>
    <message>
        <location filename="../../core/live/following.py"/>
        <source>vehicle: has sent no pose</source>
        <translation>vehículo: no ha enviado ninguna pose</translation>
    </message>
    <message>
        <location filename="../../core/live/http.py"/>
        <source>message: must be a JSON object with lat, lon and agl</source>
        <translation>mensaje: debe ser un objeto JSON con lat, lon y agl</translation>
    </message>
    <message>
        <location filename="../../core/live/http.py"/>
        <source>parameter {0!r}: must be one of {1}</source>
        <translation>parámetro {0!r}: debe ser uno de {1}</translation>
    </message>
    <message>
        <location filename="../../core/live/http.py"/>
        <source>parameter {0} {1!r}: must be a number</source>
        <translation>parámetro {0} {1!r}: debe ser un número</translation>
    </message>
    <message>
        <location filename="../../core/live/http.py"/>
        <source>parameter {0}: is missing</source>
        <translation>parámetro {0}: falta</translation>
    </message>
    <message>
        <location filename="../../core/live/http.py"/>
        <source>parameters agl and height: must be one of the two, above ground or the ellipsoid</source>
        <translation>parámetros agl y height: debe ser uno de los dos, sobre el terreno o el elipsoide</translation>
    </message>
    <message>
        <location filename="../../core/live/links.py"/>
        <source>vehicle {0!r}: MAVLink has no tokens, so the camera serves this machine alone</source>
        <translation>vehículo {0!r}: MAVLink no tiene contraseñas, así que la cámara sirve solo a este equipo</translation>
    </message>
    <message>
        <location filename="../../core/live/links.py"/>
        <location filename="../../core/mission/export/vehicle.py"/>
        <source>vehicle {0!r}: must be tcp:HOST:PORT, udp:HOST:PORT or udpout:HOST:PORT</source>
        <translation>vehículo {0!r}: debe ser tcp:HOST:PORT, udp:HOST:PORT o udpout:HOST:PORT</translation>
    </message>
    <message>
        <location filename="../../core/live/serving.py"/>
        <source>busy: {0} requests wait; ask again later</source>
        <translation>ocupado: {0} peticiones esperan; vuelva a pedirlo más tarde</translation>
    </message>
    <message>
        <location filename="../../core/live/serving.py"/>
        <source>follow: no vehicle sends its poses here</source>
        <translation>seguir: ningún vehículo envía aquí sus poses</translation>
    </message>
    <message>
        <location filename="../../core/live/serving.py"/>
        <source>give where it sends them (--fdm or --mavlink)</source>
        <translation>indique dónde las envía (--fdm o --mavlink)</translation>
    </message>
    <message>
        <location filename="../../core/live/terms.py"/>
        <source>{0}: live frames keep tiles for the next ones, which the terms forbid: {1}{2}</source>
        <translation>{0}: las imágenes en vivo guardan teselas para las siguientes, lo que prohíben las condiciones: {1}{2}</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/area.py"/>
        <location filename="../../core/mission/estimate.py"/>
        <source>area</source>
        <translation>área</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/area.py"/>
        <source>area of no polygons: needs at least one</source>
        <translation>área sin polígonos: necesita al menos uno</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/area.py"/>
        <source>area of {0:,} polygons: must be {1:,} at most</source>
        <translation>área de {0:,} polígonos: debe tener {1:,} como máximo</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/area.py"/>
        <source>box from latitude {0} down to {1}: has no height; its north must lie above its south</source>
        <translation>recuadro desde la latitud {0} hasta {1}: no tiene altura; su norte debe quedar por encima de su sur</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/area.py"/>
        <source>box from latitude {0} down to {1}: south lies above north</source>
        <translation>recuadro desde la latitud {0} hasta {1}: el sur queda al norte del norte</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/area.py"/>
        <source>box from longitude {0} to {1}: has no width; its west and its east must differ</source>
        <translation>recuadro desde la longitud {0} hasta {1}: no tiene anchura; su oeste y su este deben ser distintos</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/area.py"/>
        <source>give its corners along the pole as well</source>
        <translation>indique también sus vértices a lo largo del polo</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/area.py"/>
        <source>give the top-left corner first</source>
        <translation>dé primero la esquina superior izquierda</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/area.py"/>
        <source>latitude {0}: must be within -90 and 90 degrees</source>
        <translation>latitud {0}: debe estar entre -90 y 90 grados</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/area.py"/>
        <source>list of points is empty: needs at least one latitude, longitude and height</source>
        <translation>la lista de puntos está vacía: necesita al menos una latitud, longitud y altura</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/area.py"/>
        <source>longitude {0}: must be within -360 and 360 degrees</source>
        <translation>longitud {0}: debe estar entre -360 y 360 grados</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/area.py"/>
        <source>polygon around a pole: its sides are straight in degrees</source>
        <translation>polígono alrededor de un polo: sus lados son rectos en grados</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/area.py"/>
        <source>polygon ring of {0} corners: needs at least 3</source>
        <translation>anillo de polígono de {0} vértices: necesita al menos 3</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/area.py"/>
        <source>polygon whose sides are too many beside each other: {0:,} pairs of them share a longitude; {1:,} at most</source>
        <translation>polígono con demasiados lados uno junto a otro: {0:,} pares de ellos comparten una longitud; {1:,} como máximo</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/area.py"/>
        <source>polygon whose sides cross at latitude {0:.6f}, longitude {1:.6f}: its sides may only touch</source>
        <translation>polígono cuyos lados se cruzan en la latitud {0:.6f}, longitud {1:.6f}: sus lados solo pueden tocarse</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/area.py"/>
        <source>polygon with hole {0:,} outside of it: holes lie inside the outer ring</source>
        <translation>polígono con el hueco {0:,} fuera de él: los huecos están dentro del anillo exterior</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/area.py"/>
        <source>polygon without a ring: needs at least one of three corners</source>
        <translation>polígono sin anillo: necesita al menos uno de tres vértices</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/area.py"/>
        <source>polygon without ground: its corners lie on one line or more than half the Earth apart, or its holes are all of it</source>
        <translation>polígono sin terreno: sus vértices están en una línea o separados más de media Tierra, o sus huecos lo ocupan por completo</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/area.py"/>
        <source>put the points in the order of their times</source>
        <translation>ponga los puntos en el orden de sus horas</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/area.py"/>
        <source>rolls</source>
        <translation>alabeos</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/area.py"/>
        <source>tilts</source>
        <translation>inclinaciones</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/area.py"/>
        <source>time of point {0}: is before that of the one before it</source>
        <translation>hora del punto {0}: es anterior a la del punto precedente</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/area.py"/>
        <source>time {0!r} of point {1}: must be seconds after 1970, before the year 10000</source>
        <translation>hora {0!r} del punto {1}: debe estar en segundos desde 1970, antes del año 10000</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/area.py"/>
        <location filename="../../core/poses/settings.py"/>
        <source>times</source>
        <translation>horas</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/area.py"/>
        <source>yaws</source>
        <translation>guiñadas</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/area.py"/>
        <source>{0} {1} of {2} points: give one for each, or none</source>
        <translation>{0} {1} de {2} puntos: dé una para cada uno, o ninguna</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/area.py"/>
        <source>{0}: polygon {1:,}</source>
        <translation>{0}: polígono {1:,}</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/coords.py"/>
        <source>"lat_lon_agl", "latTL_lonTL_latBR_lonBR_agl", or a text file of "lat lon agl [yaw]" lines</source>
        <translation>"lat_lon_agl", "latTL_lonTL_latBR_lonBR_agl", o un archivo de texto con líneas "lat lon agl [guiñada]"</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/coords.py"/>
        <location filename="../../core/mission/pose_table.py"/>
        <source>coordinates</source>
        <translation>coordenadas</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/coords.py"/>
        <source>coordinates are empty: expected {0}</source>
        <translation>las coordenadas están vacías: se esperaba {0}</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/coords.py"/>
        <source>coordinates {0!r}: a raster mission needs two corners and a height (5 numbers)</source>
        <translation>coordenadas {0!r}: una misión ráster necesita dos esquinas y una altura (5 números)</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/coords.py"/>
        <source>coordinates {0!r}: there is no such file</source>
        <translation>coordenadas {0!r}: no existe tal archivo</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/coords.py"/>
        <source>coordinates {0!r}: {1} numbers; expected {2}</source>
        <translation>coordenadas {0!r}: {1} números; se esperaba {2}</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/coords.py"/>
        <location filename="../../core/poses/line.py"/>
        <source>file {0}</source>
        <translation>archivo {0}</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/coords.py"/>
        <source>file {0}: cannot be read as text ({1})</source>
        <translation>archivo {0}: no se puede leer como texto ({1})</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/coords.py"/>
        <source>file {0}: holds points; a raster mission needs two corners and a height as text</source>
        <translation>archivo {0}: contiene puntos; una misión ráster necesita dos esquinas y una altura como texto</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/coords.py"/>
        <source>file {0}: is a trajectory or a flight log</source>
        <translation>archivo {0}: es una trayectoria o un registro de vuelo</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/coords.py"/>
        <source>make a table of poses from it (terrainav poses read)</source>
        <translation>haga de él una tabla de poses (terrainav poses read)</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/coords.py"/>
        <source>mission {0!r}: must be one of {1}</source>
        <translation>misión {0!r}: debe ser una de {1}</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/coords.py"/>
        <source>unit of height {0!r}: must be one of {1}</source>
        <translation>unidad de altura {0!r}: debe ser una de {1}</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/coords.py"/>
        <source>{0!r} is not a number</source>
        <translation>{0!r} no es un número</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/coords.py"/>
        <source>{0} {1!r} has {2} numbers and the lines before {3}: give every point its yaw, or none</source>
        <translation>{0} {1!r} tiene {2} números y las líneas anteriores {3}: dé una guiñada a cada punto, o a ninguno</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/coords.py"/>
        <source>{0} {1!r} has {2} numbers; expected lat lon agl [yaw]</source>
        <translation>{0} {1!r} tiene {2} números; se esperaba lat lon agl [guiñada]</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/coords.py"/>
        <source>{0} {1!r}: {2}; expected {3}</source>
        <translation>{0} {1!r}: {2}; se esperaba {3}</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/coords.py"/>
        <location filename="../../core/mission/pose_table.py"/>
        <source>{0}, line {1}:</source>
        <translation>{0}, línea {1}:</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/coords.py"/>
        <source>{0}: holds no coordinates; expected lines of lat lon agl [yaw]</source>
        <translation>{0}: no contiene coordenadas; se esperaban líneas de lat lon agl [guiñada]</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/files.py"/>
        <source>area file {0}</source>
        <translation>archivo de área {0}</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/files.py"/>
        <source>get it with: pip install 'terrainav[{0}]', or give a GeoJSON file</source>
        <translation>obténgalo con: pip install 'terrainav[{0}]', o dé un archivo GeoJSON</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/files.py"/>
        <source>give a GeoJSON, KML or KMZ file with one or more</source>
        <translation>dé un archivo GeoJSON, KML o KMZ con uno o más</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/files.py"/>
        <source>no-fly file {0}</source>
        <translation>archivo de zonas de exclusión {0}</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/files.py"/>
        <source>{0}: a corner is not longitude, latitude ({1})</source>
        <translation>{0}: un vértice no es longitud, latitud ({1})</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/files.py"/>
        <source>{0}: cannot be read as GeoJSON, KML or KMZ ({1})</source>
        <translation>{0}: no se puede leer como GeoJSON, KML o KMZ ({1})</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/files.py"/>
        <source>{0}: cannot be read as KML ({1})</source>
        <translation>{0}: no se puede leer como KML ({1})</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/files.py"/>
        <source>{0}: cannot be read as KMZ ({1})</source>
        <translation>{0}: no se puede leer como KMZ ({1})</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/files.py"/>
        <source>{0}: corner {1!r} is not longitude,latitude</source>
        <translation>{0}: el vértice {1!r} no es longitud,latitud</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/files.py"/>
        <source>{0}: holds more than {1:,} files</source>
        <translation>{0}: contiene más de {1:,} archivos</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/files.py"/>
        <source>{0}: holds more than {1:,} polygons</source>
        <translation>{0}: contiene más de {1:,} polígonos</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/files.py"/>
        <source>{0}: holds no polygon</source>
        <translation>{0}: no contiene ningún polígono</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/files.py"/>
        <source>{0}: is a zip without a KML file</source>
        <translation>{0}: es un zip sin archivo KML</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/files.py"/>
        <source>{0}: is compressed in a way that KMZ does not use</source>
        <translation>{0}: está comprimido de una forma que KMZ no usa</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/files.py"/>
        <source>{0}: its KML is larger than {1} MB</source>
        <translation>{0}: su KML ocupa más de {1} MB</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/files.py"/>
        <source>{0}: polygon {1:,}: {2}</source>
        <translation>{0}: polígono {1:,}: {2}</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/files.py"/>
        <source>{0}: {1}, which reads KML, is not installed</source>
        <translation>{0}: {1}, que lee KML, no está instalado</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/geojson.py"/>
        <source>{0}: a side runs through a pole, across the edge of the map of {1}, or too far; must be cut</source>
        <translation>{0}: un lado pasa por un polo, por el borde del mapa de {1} o demasiado lejos; debe cortarse</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/geojson.py"/>
        <source>{0}: corner {1:g}, {2:g} is outside the domain of its crs {3}</source>
        <translation>{0}: el vértice {1:g}, {2:g} está fuera del dominio de su crs {3}</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/geojson.py"/>
        <source>{0}: its crs has no name; must be a name such as EPSG:25832, or left out for WGS 84</source>
        <translation>{0}: su crs no tiene nombre; debe ser un nombre como EPSG:25832, o faltar si es WGS 84</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/geojson.py"/>
        <source>{0}: its crs is a link ({1}), which is not followed; must be a name such as EPSG:25832</source>
        <translation>{0}: su crs es un enlace ({1}), que no se sigue; debe ser un nombre como EPSG:25832</translation>
    </message>
    <message>
        <location filename="../../core/mission/areas/geojson.py"/>
        <source>{0}: its crs {1!r} is not a geographic or projected reference system that PROJ knows; must be a code such as EPSG:25832</source>
        <translation>{0}: su crs {1!r} no es ningún sistema de referencia geográfico o proyectado que PROJ conozca; debe ser un código como EPSG:25832</translation>
    </message>
    <message>
        <location filename="../../core/mission/cameras.py"/>
        <source>camera name {0!r}: must be 1 to {1} characters of one line, with single spaces inside</source>
        <translation>nombre de cámara {0!r}: debe tener de 1 a {1} caracteres en una línea, con espacios sencillos en su interior</translation>
    </message>
    <message>
        <location filename="../../core/mission/cameras.py"/>
        <source>camera name {0!r}: {1} is taken</source>
        <translation>nombre de cámara {0!r}: {1} ya está en uso</translation>
    </message>
    <message>
        <location filename="../../core/mission/cameras.py"/>
        <source>camera {0!r} is unknown: {1}`terrainav cameras` lists the names</source>
        <translation>cámara {0!r} desconocida: {1}`terrainav cameras` enumera los nombres</translation>
    </message>
    <message>
        <location filename="../../core/mission/cameras.py"/>
        <source>camera {0!r}: comes with TerrAInav, and stays as it is</source>
        <translation>cámara {0!r}: viene con TerrAInav, y se queda como está</translation>
    </message>
    <message>
        <location filename="../../core/mission/cameras.py"/>
        <source>camera {0!r}: not one of your own, which are {1}</source>
        <translation>cámara {0!r}: no es ninguna de las propias, que son {1}</translation>
    </message>
    <message>
        <location filename="../../core/mission/cameras.py"/>
        <source>camera {0}: must be an object</source>
        <translation>cámara {0}: debe ser un objeto</translation>
    </message>
    <message>
        <location filename="../../core/mission/cameras.py"/>
        <source>camera {0}: {1}</source>
        <translation>cámara {0}: {1}</translation>
    </message>
    <message>
        <location filename="../../core/mission/cameras.py"/>
        <source>cameras</source>
        <translation>cámaras</translation>
    </message>
    <message>
        <location filename="../../core/mission/cameras.py"/>
        <source>image_px {0!r}: must be a whole number</source>
        <translation>image_px {0!r}: debe ser un número entero</translation>
    </message>
    <message>
        <location filename="../../core/mission/cameras.py"/>
        <source>no field of view</source>
        <translation>no hay campo de visión</translation>
    </message>
    <message>
        <location filename="../../core/mission/cameras.py"/>
        <source>sensor_mm and focal_length_mm: one needs the other</source>
        <translation>sensor_mm y focal_length_mm: el uno necesita al otro</translation>
    </message>
    <message>
        <location filename="../../core/mission/cameras.py"/>
        <source>size_px and {0}: give one of the two</source>
        <translation>size_px y {0}: dé uno de los dos</translation>
    </message>
    <message>
        <location filename="../../core/mission/cameras.py"/>
        <source>size_px {0!r}: must be whole numbers</source>
        <translation>size_px {0!r}: deben ser números enteros</translation>
    </message>
    <message>
        <location filename="../../core/mission/cameras.py"/>
        <source>source {0!r}: must be text of one line</source>
        <translation>fuente {0!r}: debe ser texto de una línea</translation>
    </message>
    <message>
        <location filename="../../core/mission/cameras.py"/>
        <source>{0} {1!r}: must be a list of width and height, each above 0</source>
        <translation>{0} {1!r}: debe ser una lista de anchura y altura, ambas mayores que 0</translation>
    </message>
    <message>
        <location filename="../../core/mission/cameras.py"/>
        <source>{0} {1!r}: must be a number above 0</source>
        <translation>{0} {1!r}: debe ser un número mayor que 0</translation>
    </message>
    <message>
        <location filename="../../core/mission/cameras.py"/>
        <source>{0} {1!r}: needs aspect_ratio or size_px beside it</source>
        <translation>{0} {1!r}: necesita al lado aspect_ratio o size_px</translation>
    </message>
    <message>
        <location filename="../../core/mission/cameras.py"/>
        <source>{0} {1!r}: needs size_px beside it</source>
        <translation>{0} {1!r}: necesita también size_px</translation>
    </message>
    <message>
        <location filename="../../core/mission/cameras.py"/>
        <source>{0}: give one of {1}</source>
        <translation>{0}: dé uno de {1}</translation>
    </message>
    <message>
        <location filename="../../core/mission/clock.py"/>
        <source>give seconds after 1970, or remove the column of times</source>
        <translation>indique segundos desde 1970 o quite la columna de tiempos</translation>
    </message>
    <message>
        <location filename="../../core/mission/clock.py"/>
        <source>its times, as seconds from {0:.7g} to {1:.7g}, are not of 1990 to 2099</source>
        <translation>sus tiempos, como segundos de {0:.7g} a {1:.7g}, no son de 1990 a 2099</translation>
    </message>
    <message>
        <location filename="../../core/mission/clock.py"/>
        <source>its {0:,} times are all within {1:.3g} s</source>
        <translation>sus {0:,} tiempos caben todos en {1:.3g} s</translation>
    </message>
    <message>
        <location filename="../../core/mission/clock.py"/>
        <location filename="../../core/units.py"/>
        <source>microseconds</source>
        <translation>microsegundos</translation>
    </message>
    <message>
        <location filename="../../core/mission/clock.py"/>
        <location filename="../../core/units.py"/>
        <source>milliseconds</source>
        <translation>milisegundos</translation>
    </message>
    <message>
        <location filename="../../core/mission/clock.py"/>
        <source>nanoseconds</source>
        <translation>nanosegundos</translation>
    </message>
    <message>
        <location filename="../../core/mission/clock.py"/>
        <location filename="../../core/units.py"/>
        <source>seconds</source>
        <translation>segundos</translation>
    </message>
    <message>
        <location filename="../../core/mission/clock.py"/>
        <source>{0}; they are probably not in {1}</source>
        <translation>{0}; probablemente no están en {1}</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source> a map type</source>
        <translation> por tipo de mapa</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source> for each of {0} map types</source>
        <translation> para cada uno de {0} tipos de mapa</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>about {0}</source>
        <translation>unos {0}</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>cameras.json for OpenDroneMap is empty where different lenses have one focal length</source>
        <translation>cameras.json para OpenDroneMap queda vacío si lentes distintas tienen la misma distancia focal</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>complete</source>
        <translation>completa</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>complete but for missing imagery</source>
        <translation>completa, salvo donde faltan imágenes</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>coverage</source>
        <translation>cobertura</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>download</source>
        <translation>descarga</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>files</source>
        <translation>archivos</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>flight distance</source>
        <translation>distancia de vuelo</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <location filename="../../core/mission/flight/joined.py"/>
        <source>flight path</source>
        <translation>trayectoria de vuelo</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>flight time</source>
        <translation>tiempo de vuelo</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>from {0:,.1f} to {1:,.1f} m above the ellipsoid, captures at least {2:,.1f} m clear</source>
        <translation>de {0:,.1f} a {1:,.1f} m sobre el elipsoide, capturas con al menos {2:,.1f} m libres</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>front overlap</source>
        <translation>solape longitudinal</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>greatest speed</source>
        <translation>velocidad máxima</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>ground below</source>
        <translation>terreno debajo</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>ground sample distance</source>
        <translation>distancia de muestreo del terreno</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>holes filled</source>
        <translation>huecos rellenados</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>holes interpolated</source>
        <translation>huecos interpolados</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <location filename="../../core/mission/methods.py"/>
        <source>image</source>
        <translation>imagen</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>imagery</source>
        <translation>imágenes de la fuente</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <location filename="../../core/mission/flight/joined.py"/>
        <source>images</source>
        <translation>imágenes</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>least {0:.2f} %, median {1:.2f} %</source>
        <translation>mínimo {0:.2f} %, mediana {1:.2f} %</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>means of {2} x {2} of the source's own pixels, {0} in {1}</source>
        <translation>medias de {2} x {2} de los píxeles propios de la fuente, {0} en {1}</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>motion in images</source>
        <translation>movimiento en las imágenes</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>nothing (computed here)</source>
        <translation>nada (se calcula aquí)</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>nothing (read from the file)</source>
        <translation>nada (se lee del archivo)</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>of {0:,} images {1:,} lie outside the source's imagery, and {2:,} reach beyond it; choose an area that it has imagery of, or another source</source>
        <translation>de {0:,} imágenes, {1:,} quedan fuera de lo que tiene la fuente y {2:,} lo sobrepasan; elija un área de la que tenga imágenes, u otra fuente</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>over no-fly areas</source>
        <translation>sobre zonas de exclusión</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>over the relief</source>
        <translation>sobre el relieve</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>requested {0}, but the source has {1} here (zoom {2}): upsampled {3:.3g} times, images show no more detail; ask for {4}</source>
        <translation>se piden {0}, pero la fuente tiene aquí {1} (zoom {2}): sobremuestreadas {3:.3g} veces, las imágenes no muestran más detalle; pida {4}</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>requested {0}, delivered {1}</source>
        <translation>pedida {0}, entregada {1}</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>rows, columns</source>
        <translation>pasadas, columnas</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>side overlap</source>
        <translation>solape transversal</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>skipped rows</source>
        <translation>pasadas omitidas</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <location filename="../../core/mission/flight/joined.py"/>
        <source>sorties</source>
        <translation>salidas</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <location filename="../../core/mission/parts/sunlight.py"/>
        <source>sun</source>
        <translation>sol</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>the source has imagery of {0} of the area</source>
        <translation>la fuente tiene imágenes del {0} del área</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>the source's own pixels, {0} in {1}</source>
        <translation>los píxeles propios de la fuente, {0} en {1}</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>the source's own pixels, {0} in {1}, upsampled {2} times</source>
        <translation>los píxeles propios de la fuente, de {0} en {1}, sobremuestreados {2} veces</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>tiles</source>
        <translation>teselas</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>time</source>
        <translation>tiempo</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <location filename="../../core/mission/flight/joined.py"/>
        <source>time in the air</source>
        <translation>tiempo en el aire</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>vary {0!r}: changes no image while the exposure is {1}; choose another one{2}</source>
        <translation>vary {0!r}: no cambia ninguna imagen mientras la exposición sea {1}; elija otra{2}</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>warning</source>
        <translation>aviso</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>{0:,.1f} m above the ellipsoid everywhere</source>
        <translation>{0:,.1f} m sobre el elipsoide en todas partes</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>{0:,} images left out</source>
        <translation>{0:,} imágenes omitidas</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>{0:,} of {1:,} heights around the area ({2}), from the heights around them</source>
        <translation>{0:,} de {1:,} alturas en torno al área ({2}), de las alturas que las rodean</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>{0:,} of {1:,} heights around the area ({2}), from the next source</source>
        <translation>{0:,} de {1:,} alturas en torno al área ({2}), de la fuente siguiente</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>{0:,} polygons, {1}</source>
        <translation>{0:,} polígonos, {1}</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>{0:,}{1}, each fetched once</source>
        <translation>{0:,}{1}, cada una pedida una vez</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>{0:.0f} bytes</source>
        <translation>{0:.0f} bytes</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>{0} of the area outside no-fly areas</source>
        <translation>{0} del área fuera de las zonas de exclusión</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>{0} per pixel at the highest point, {1} at the lowest</source>
        <translation>{0} por píxel en lo más alto, {1} en lo más bajo</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>{0} uncovered</source>
        <translation>{0} sin cubrir</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>{0} x {1} px at zoom {2}</source>
        <translation>{0} x {1} px con zoom {2}</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>{0} x {1} px: {2}</source>
        <translation>{0} x {1} px: {2}</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>{0} {1} or a finer source</source>
        <translation>{0} {1} o una fuente más fina</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>{0} {1} or less, or fly higher</source>
        <translation>{0} {1} o menos, o volar más alto</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>{0} {1} {2} {3} or less</source>
        <translation>{0} {1} {2} {3} o menos</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>{0}, {1} of the area</source>
        <translation>{0}, {1} del área</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <location filename="../../core/mission/flight/joined.py"/>
        <source>{0}, {1} with turns</source>
        <translation>{0}, {1} con los giros</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>{0}: {1:,} images left out</source>
        <translation>{0}: {1:,} imágenes omitidas</translation>
    </message>
    <message>
        <location filename="../../core/mission/estimate.py"/>
        <source>{0}; relief hides about {1:.1f} %</source>
        <translation>{0}; el relieve oculta cerca del {1:.1f} %</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/clearance.py"/>
        <source>read back: {0:,} waypoints; {1:,} images at most {2:.2f} m from their planned height (latitude {3:.6f}, longitude {4:.6f}), {5:.1f} to {6:.1f} m above ground</source>
        <translation>leído de nuevo: {0:,} puntos de paso; {1:,} imágenes a un máximo de {2:.2f} m de su altura planificada (latitud {3:.6f}, longitud {4:.6f}), de {5:.1f} a {6:.1f} m sobre el suelo</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/clearance.py"/>
        <source>{0}: between waypoints {1} and {2} the flight comes {5:.2f} m below the surface, at latitude {3:.6f}, longitude {4:.6f}</source>
        <translation>{0}: entre los puntos de paso {1} y {2} el vuelo queda {5:.2f} m por debajo de la superficie, en la latitud {3:.6f}, longitud {4:.6f}</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/clearance.py"/>
        <source>{0}: between waypoints {1} and {2} the flight comes {5:.2f} m short of its clearance of {6:g} m, at latitude {3:.6f}, longitude {4:.6f}</source>
        <translation>{0}: entre los puntos de paso {1} y {2} al vuelo le faltan {5:.2f} m para su distancia de seguridad de {6:g} m, en la latitud {3:.6f}, longitud {4:.6f}</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/geopackage.py"/>
        <source>footprints and captures are those of the flight in wind, the flight line is the one that was meant</source>
        <translation>las huellas y las capturas son las del vuelo con viento; la línea de vuelo, la prevista</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/geopackage.py"/>
        <source>footprints and captures are those of the random poses, the flight line is the planned one</source>
        <translation>las huellas y las capturas son las de las poses aleatorias; la línea de vuelo es la planificada</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/geopackage.py"/>
        <source>install it, or choose .geojson</source>
        <translation>instálelo, o elija .geojson</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/geopackage.py"/>
        <source>{0}: GeoPackages need GDAL's Python module (osgeo), which QGIS brings along</source>
        <translation>{0}: los GeoPackage necesitan el módulo de Python de GDAL (osgeo), que QGIS trae consigo</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/geopackage.py"/>
        <source>{0}: cannot be written ({1})</source>
        <translation>{0}: no se puede escribir ({1})</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/gpx.py"/>
        <source>heights are above ground, in each point's description; GPX's own are above the sea</source>
        <translation>las alturas son sobre el terreno, en la descripción de cada punto; las propias de GPX son sobre el mar</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/kml.py"/>
        <source>footprints are those of the flight in wind, waypoints and flight line are those that were meant</source>
        <translation>las huellas son las del vuelo con viento; los puntos de ruta y la línea de vuelo, los previstos</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/kml.py"/>
        <source>footprints are those of the random poses, waypoints and flight line are the planned ones</source>
        <translation>las huellas son las de las poses aleatorias; los puntos de paso y la línea de vuelo son los planificados</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/kml.py"/>
        <source>{0:,} captures are more than Google Earth opens: the file has the flight line alone; footprints and waypoints come with up to {1:,}</source>
        <translation>{0:,} capturas son más de las que abre Google Earth: el archivo tiene solo la línea de vuelo; las huellas y los puntos de ruta se incluyen hasta {1:,}</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/litchi.py"/>
        <source>Litchi mission at {0:g} m: must be {1:g} m above ground or less</source>
        <translation>misión Litchi a {0:g} m: debe estar a {1:g} m sobre el terreno o menos</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/litchi.py"/>
        <source>Litchi mission of one waypoint: takes two or more</source>
        <translation>misión Litchi de un punto de ruta: lleva dos o más</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/litchi.py"/>
        <source>Litchi mission of {0:,} waypoints: takes {1:,} or fewer</source>
        <translation>misión Litchi de {0:,} puntos de ruta: lleva {1:,} o menos</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/litchi.py"/>
        <source>Litchi mission with the gimbal lifted to {0:g} deg: must be {1:g} to {2:g}, a tilt of {3:g} or less</source>
        <translation>misión Litchi con el estabilizador levantado a {0:g} grados: debe estar entre {1:g} y {2:g}, una inclinación de {3:g} o menos</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/litchi.py"/>
        <source>in Litchi set Heading Mode to Custom and Path Mode to Straight Lines, which the file cannot say</source>
        <translation>en Litchi, poner Heading Mode en Custom y Path Mode en Straight Lines, lo que el archivo no puede indicar</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/litchi.py"/>
        <location filename="../../core/mission/export/wpml.py"/>
        <source>plan a list or an area</source>
        <translation>planifique una lista o un área</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/litchi.py"/>
        <location filename="../../core/mission/export/qgroundcontrol.py"/>
        <location filename="../../core/mission/export/wpml.py"/>
        <source>plan a smaller area, a greater height or less overlap</source>
        <translation>planifique un área menor, una altura mayor o menos solape</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/litchi.py"/>
        <source>sorties begin at the parts {0}</source>
        <translation>las salidas empiezan en las partes {0}</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/litchi.py"/>
        <source>the speed of {0:g} m/s is reduced to Litchi's {1:g} m/s</source>
        <translation>la velocidad de {0:g} m/s se reduce a los {1:g} m/s de Litchi</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/qgroundcontrol.py"/>
        <source>QGroundControl plan at {0:g} m: must be below {1:g} m above the take-off</source>
        <translation>Plan de QGroundControl a {0:g} m: debe estar a menos de {1:g} m sobre el despegue</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/qgroundcontrol.py"/>
        <source>QGroundControl plan of {0:,} waypoints: takes {1:,} or fewer</source>
        <translation>plan de QGroundControl de {0:,} puntos de ruta: lleva {1:,} o menos</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/qgroundcontrol.py"/>
        <location filename="../../core/mission/export/wpml.py"/>
        <source>heights are above the take-off point, computed for ground at {0:.1f} m above the ellipsoid there</source>
        <translation>las alturas son sobre el punto de despegue, calculadas para un terreno que está allí a {0:.1f} m sobre el elipsoide</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/qgroundcontrol.py"/>
        <source>heights are above the take-off point: they are heights above ground only where the ground is level with it</source>
        <translation>las alturas son sobre el punto de despegue: solo son alturas sobre el terreno donde este está a su mismo nivel</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/rows.py"/>
        <source>start earlier</source>
        <translation>empiece antes</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/rows.py"/>
        <source>start {0!r}: the flight of {1:.3g} s goes beyond the year 9999</source>
        <translation>inicio {0!r}: el vuelo de {1:.3g} s rebasa el año 9999</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/survey.py"/>
        <source>QGroundControl lays the rows anew when you edit the survey, or open it at another speed than its own: within a metre or two of the planned ones, with the nose along the flight</source>
        <translation>QGroundControl vuelve a trazar las filas cuando se edita el levantamiento o se abre con una velocidad distinta de la suya: a uno o dos metros de las planificadas, con el morro en el sentido del vuelo</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/survey.py"/>
        <source>QGroundControl survey with a tilt of {0:g} and a roll of {1:g} deg: must look straight down</source>
        <translation>levantamiento de QGroundControl con una inclinación de {0:g} y un alabeo de {1:g} grados: debe mirar en vertical hacia abajo</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/survey.py"/>
        <source>QGroundControl survey with images {0:g} deg off the direction of rows: must be along or across them</source>
        <translation>levantamiento de QGroundControl con imágenes giradas {0:g} grados respecto a las filas: deben estar a lo largo o a través de ellas</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/survey.py"/>
        <source>QGroundControl survey: needs an area of one polygon without holes</source>
        <translation>levantamiento de QGroundControl: necesita un área de un solo polígono sin huecos</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/survey.py"/>
        <source>QGroundControl survey: takes one mission, and {0} are joined</source>
        <translation>levantamiento de QGroundControl: admite una misión, y hay {0} unidas</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/survey.py"/>
        <source>choose the ending .plan</source>
        <translation>elija la extensión .plan</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/survey.py"/>
        <source>crossing rows laid anew are as far apart as the first ones</source>
        <translation>las filas cruzadas que vuelve a trazar quedan a la misma distancia que las primeras</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/survey.py"/>
        <source>rows laid anew are flown to and fro</source>
        <translation>las filas que vuelve a trazar se vuelan de ida y vuelta</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/survey.py"/>
        <source>rows laid anew include the skipped ones</source>
        <translation>las pasadas trazadas de nuevo incluyen las omitidas</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/vehicle.py"/>
        <source>choose one from 1 to {0}{1}</source>
        <translation>elija una de 1 a {0}{1}</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/vehicle.py"/>
        <source>flight of {0} sorties: a vehicle takes one</source>
        <translation>vuelo de {0} salidas: un vehículo admite una</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/vehicle.py"/>
        <source>upload to a vehicle: the Python package {0} is missing</source>
        <translation>envío a un vehículo: falta el paquete de Python {0}</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/vehicle.py"/>
        <source>vehicle {0}: cannot be reached ({1})</source>
        <translation>vehículo {0}: no se puede alcanzar ({1})</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/vehicle.py"/>
        <source>vehicle {0}: did not answer {1} times</source>
        <translation>vehículo {0}: no respondió {1} veces</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/vehicle.py"/>
        <source>vehicle {0}: refused the mission ({1})</source>
        <translation>vehículo {0}: rechazó la misión ({1})</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/vehicle.py"/>
        <source>vehicle {0}: sent no heartbeat within {1:g} s</source>
        <translation>vehículo {0}: no envió ningún latido en {1:g} s</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/vehicle.py"/>
        <source>vehicle {0}: the connection broke ({1})</source>
        <translation>vehículo {0}: se cortó la conexión ({1})</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/waypoints.py"/>
        <source>random poses are left out: waypoints are at the planned positions</source>
        <translation>las poses aleatorias se omiten: los puntos de paso están en las posiciones planificadas</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/waypoints.py"/>
        <source>the roll of {0:g} deg is left out: waypoints have none</source>
        <translation>se omite el alabeo de {0:g} grados: los puntos de ruta no lo tienen</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/waypoints.py"/>
        <source>the tilt of {0:g} deg is flown with the aircraft turned around: same ground, images upside down</source>
        <translation>la inclinación de {0:g} grados se vuela con la aeronave dada la vuelta: mismo terreno, imágenes invertidas</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/waypoints.py"/>
        <source>wind is left out: waypoints are at the planned positions</source>
        <translation>se omite el viento: los lugares son los previstos</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/wpml.py"/>
        <source>DJI Fly opens no files: put this one in the place of a mission that you made there</source>
        <translation>DJI Fly no abre archivos: ponga este en lugar de una misión creada allí</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/wpml.py"/>
        <source>DJI Fly releases no camera by distance: each image has a waypoint of its own</source>
        <translation>DJI Fly no dispara la cámara por distancia: cada imagen tiene su propio punto de ruta</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/wpml.py"/>
        <source>DJI mission at {0:g} m/s: must be {1:g} to {2:g} m/s</source>
        <translation>misión DJI a {0:g} m/s: debe ser de {1:g} a {2:g} m/s</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/wpml.py"/>
        <source>DJI mission at {0:g} m: must be {1:g} m above the take-off or less</source>
        <translation>misión DJI a {0:g} m: debe ser de {1:g} m sobre el despegue como máximo</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/wpml.py"/>
        <source>DJI mission of one waypoint: takes two or more</source>
        <translation>misión DJI de un solo punto de ruta: admite dos o más</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/wpml.py"/>
        <source>DJI mission of {0:,} waypoints: takes {1:,} or fewer, in {2} files</source>
        <translation>misión DJI de {0:,} puntos de ruta: admite {1:,} como máximo, en {2} archivos</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/wpml.py"/>
        <source>DJI mission with the gimbal lifted to {0:g} deg: must be {1:g} to {2:g}, a tilt of {3:g} or less</source>
        <translation>misión DJI con el estabilizador elevado a {0:g} grados: debe ser de {1:g} a {2:g}, una inclinación de {3:g} como máximo</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/wpml.py"/>
        <source>heights are above the take-off point, which is taken to be below the first waypoint of each file: ground at {0:.1f} to {1:.1f} m above the ellipsoid</source>
        <translation>las alturas son sobre el punto de despegue, que se supone bajo el primer punto de cada archivo: suelo a entre {0:.1f} y {1:.1f} m sobre el elipsoide</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/wpml.py"/>
        <source>not flown yet: files for DJI's programs were checked by their structure and by reading them back</source>
        <translation>aún sin volar: los archivos para los programas de DJI se han comprobado por su estructura y volviéndolos a leer</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/wpml.py"/>
        <source>the drone stops at each waypoint; times and sorties count these stops with the trigger hover alone</source>
        <translation>el dron se detiene en cada punto de ruta; los tiempos y las salidas cuentan esas paradas solo con el disparo hover</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/wpml.py"/>
        <source>the file is for the drone {0}</source>
        <translation>el archivo es para el dron {0}</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/wpml.py"/>
        <source>the speed of {0:g} m/s is reduced to DJI's {1:g} m/s</source>
        <translation>la velocidad de {0:g} m/s se reduce a los {1:g} m/s de DJI</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/writing.py"/>
        <source>not of this flight, and left as they were: {0}</source>
        <translation>no son de este vuelo y quedan como estaban: {0}</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/writing.py"/>
        <source>plan file {0!r}: must be on this machine, as all {1} files</source>
        <translation>archivo de plan {0!r}: debe estar en este equipo, como todos los archivos {1}</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/writing.py"/>
        <source>plan file {0!r}: must end in {1}</source>
        <translation>archivo de plan {0!r}: debe terminar en {1}</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/writing.py"/>
        <source>{0} parts of one flight, {1} to {2}</source>
        <translation>{0} partes de un vuelo, de {1} a {2}</translation>
    </message>
    <message>
        <location filename="../../core/mission/export/writing.py"/>
        <source>{0}, part {1}</source>
        <translation>{0}, parte {1}</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/alignment.py"/>
        <source>alignment: stopped</source>
        <translation>alineación: detenida</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/alignment.py"/>
        <source>points have no rows that could be aligned</source>
        <translation>los puntos no tienen pasadas que alinear</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/alignment.py"/>
        <source>row azimuth {0:g}°: {1}, {2}, as before</source>
        <translation>acimut de las pasadas {0:g}°: {1}, {2}, como antes</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/alignment.py"/>
        <source>row azimuth {0:g}°: {1}, {2}, as long as {3:g}°</source>
        <translation>acimut de las pasadas {0:g}°: {1}, {2}, tan largo como con {3:g}°</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/alignment.py"/>
        <source>row azimuth {0:g}°: {1}, {2}, {3} % longer than {4:g}°</source>
        <translation>acimut de las pasadas {0:g}°: {1}, {2}, un {3} % más largo que con {4:g}°</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/alignment.py"/>
        <source>row azimuth {0:g}°: {1}, {2}, {3} % shorter than {4:g}°</source>
        <translation>acimut de las pasadas {0:g}°: {1}, {2}, un {3} % más corto que con {4:g}°</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/alignment.py"/>
        <source>rows to be aligned: a split after image {0} would be elsewhere then</source>
        <translation>pasadas por alinear: la división tras la imagen {0} quedaría en otro lugar</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/alignment.py"/>
        <source>rows to be aligned: the layout {0} is north-up</source>
        <translation>pasadas por alinear: la disposición {0} tiene el norte arriba</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/alignment.py"/>
        <source>rows to be aligned: the skipped rows {0} would be others then</source>
        <translation>pasadas por alinear: las pasadas omitidas {0} serían otras</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/alignment.py"/>
        <location filename="../../core/mission/layout/paper.py"/>
        <location filename="../../core/mission/layout/polygons.py"/>
        <location filename="../../core/mission/layout/rotated.py"/>
        <source>use {0} {1}</source>
        <translation>use {0} {1}</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/alignment.py"/>
        <source>{0} row</source>
        <translation>{0} pasada</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/alignment.py"/>
        <source>{0} rows</source>
        <translation>{0} pasadas</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/alignment.py"/>
        <source>{0} with turns</source>
        <translation>{0} con giros</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/gusts.py"/>
        <source>steps of {0} to {1} s: must be 0 or more, and finite</source>
        <translation>pasos de {0} a {1} s: deben ser 0 o más, y finitos</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/gusts.py"/>
        <source>system without a stationary covariance: it must be stable</source>
        <translation>sistema sin covarianza estacionaria: debe ser estable</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/joined.py"/>
        <source>between missions</source>
        <translation>entre misiones</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/joined.py"/>
        <source>camera</source>
        <translation>cámara</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/joined.py"/>
        <source>least clearance</source>
        <translation>distancia mínima al terreno</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/joined.py"/>
        <source>mission {0} with a split after image {1}: it has {2:,} images</source>
        <translation>misión {0} con una división tras la imagen {1}: tiene {2:,} imágenes</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/joined.py"/>
        <source>one flight of several missions: needs two or more</source>
        <translation>un vuelo de varias misiones: requiere dos o más</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/joined.py"/>
        <source>one flight of {0} and {1}: they differ in {2}, which a flight has in common</source>
        <translation>un vuelo de {0} y {1}: difieren en {2}, que un vuelo tiene en común</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/joined.py"/>
        <location filename="../../core/mission/methods.py"/>
        <location filename="../../core/report/measure.py"/>
        <source>wind</source>
        <translation>viento</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/motion.py"/>
        <source>yaws of shape {0}: must be one, or one for each of {1} exposures</source>
        <translation>guiñadas de forma {0}: debe ser una, o una para cada una de {1} exposiciones</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/motion.py"/>
        <source>{0} of shape {1}: must be {2} for {3} exposures</source>
        <translation>{0} de forma {1}: debe ser {2} para {3} exposiciones</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/path.py"/>
        <source>battery of {0:g} min: the flight needs more than {1:,} sorties</source>
        <translation>batería de {0:g} min: el vuelo necesita más de {1:,} salidas</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/path.py"/>
        <source>battery of {0:g} min: the way to image {1:,} and back takes {2:.1f} min</source>
        <translation>batería de {0:g} min: ir hasta la imagen {1:,} y volver lleva {2:.1f} min</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/path.py"/>
        <source>split after image {0:,}: must be from 1 to {1:,}, as the flight has {2:,} images</source>
        <translation>división tras la imagen {0:,}: debe ser de 1 a {1:,}, pues el vuelo tiene {2:,} imágenes</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/path.py"/>
        <source>take a smaller area, a nearer take-off or a larger battery</source>
        <translation>tome un área menor, un despegue más cercano o una batería mayor</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/path.py"/>
        <source>take off nearer to it, fly faster or take a larger battery</source>
        <translation>despegue más cerca de ella, vuele más deprisa o tome una batería mayor</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/path.py"/>
        <source>take-off at latitude {0:.6f}, longitude {1:.6f}: lies inside a no-fly area</source>
        <translation>despegue en la latitud {0:.6f}, longitud {1:.6f}: está dentro de una zona de exclusión aérea</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/pilot.py"/>
        <source>airspeed auto: needs a limit of the camera</source>
        <translation>velocidad auto: necesita un límite de la cámara</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/pilot.py"/>
        <source>airspeed auto: no speed is slow enough for the camera</source>
        <translation>velocidad auto: ninguna velocidad es lo bastante lenta para la cámara</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/pilot.py"/>
        <source>east</source>
        <translation>este</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/pilot.py"/>
        <source>give its minimum image interval{0} or its exposure time{1}</source>
        <translation>indique su intervalo mínimo de imágenes{0} o su tiempo de exposición{1}</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/pilot.py"/>
        <source>images every {0:.2g} s: the camera takes one every {1:g} s</source>
        <translation>imágenes cada {0:.2g} s: la cámara toma una cada {1:g} s</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/pilot.py"/>
        <source>motion blur of {0:.2g} px: more than {1:g} px</source>
        <translation>desenfoque de movimiento de {0:.2g} px: más de {1:g} px</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/pilot.py"/>
        <source>north</source>
        <translation>norte</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/pilot.py"/>
        <source>north-east</source>
        <translation>noreste</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/pilot.py"/>
        <source>north-west</source>
        <translation>noroeste</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/pilot.py"/>
        <source>overlap less or fly higher</source>
        <translation>solape menos o vuele más alto</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/pilot.py"/>
        <source>south</source>
        <translation>sur</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/pilot.py"/>
        <source>south-east</source>
        <translation>sureste</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/pilot.py"/>
        <source>south-west</source>
        <translation>suroeste</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/pilot.py"/>
        <source>west</source>
        <translation>oeste</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/pilot.py"/>
        <source>{0:.0f}° below the horizon in the {1}</source>
        <translation>{0:.0f}° bajo el horizonte al {1}</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/pilot.py"/>
        <source>{0:.0f}° high in the {1}</source>
        <translation>a {0:.0f}° de altura al {1}</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/pilot.py"/>
        <source>{0:.1f} min; batteries of the {1}: {2:,}</source>
        <translation>{0:.1f} min; baterías del {1}: {2:,}</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/pilot.py"/>
        <source>{0:.1f} to {1:.1f}</source>
        <translation>de {0:.1f} a {1:.1f}</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/pilot.py"/>
        <source>{0:g} m/s for an image every {1:g} s</source>
        <translation>{0:g} m/s para una imagen cada {1:g} s</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/pilot.py"/>
        <source>{0:g} m/s for {1:g} px of blur in {2:g} ms</source>
        <translation>{0:g} m/s para {1:g} px de desenfoque en {2:g} ms</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/pilot.py"/>
        <source>{0}, at the end {1}</source>
        <translation>{0}, al final {1}</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/pilot.py"/>
        <source>{0}: a bright spot, and glint on water, lie in the images</source>
        <translation>{0}: en las imágenes hay un punto brillante y reflejos en el agua</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/pilot.py"/>
        <source>{0}: long shadows</source>
        <translation>{0}: sombras largas</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/pilot.py"/>
        <source>{0}: night</source>
        <translation>{0}: noche</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/pilot.py"/>
        <source>{0}: {1} min</source>
        <translation>{0}: {1} min</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/pilot.py"/>
        <source>{0}: {1} of {2:g} min</source>
        <translation>{0}: {1} de {2:g} min</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/pilot.py"/>
        <source>{0}; fly at {1:g} m/s or slower ({2})</source>
        <translation>{0}; vuele a {1:g} m/s o más despacio ({2})</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/pilot.py"/>
        <source>{0}; overlap less or fly higher</source>
        <translation>{0}; reduzca el solape o vuele más alto</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/varied.py"/>
        <source>fly higher, or choose another distribution</source>
        <translation>vuele más alto o elija otra distribución</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/varied.py"/>
        <source>vary {0!r}: one of the cameras would be {1:g} m above the ground</source>
        <translation>vary {0!r}: una de las cámaras estaría a {1:g} m sobre el terreno</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/wind.py"/>
        <source>direction the wind blows from, clockwise from north</source>
        <translation>dirección desde la que sopla el viento, en sentido horario desde el norte</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/wind.py"/>
        <source>mean wind at flight height, below the airspeed</source>
        <translation>viento medio a la altura de vuelo, menor que la velocidad aérea</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/wind.py"/>
        <source>seed of the gusts</source>
        <translation>de las ráfagas</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/wind.py"/>
        <source>seed of the wind</source>
        <translation>semilla del viento</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/wind.py"/>
        <source>standard deviation of the gusts over the mean wind: about 0.1 over water, 0.2 over fields, 0 for a steady wind</source>
        <translation>desviación típica de las ráfagas entre el viento medio: cerca de 0.1 sobre el agua, 0.2 sobre campos, 0 con viento constante</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/wind.py"/>
        <source>turbulence</source>
        <translation>turbulencia</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/wind.py"/>
        <source>turbulence intensity {0}: gusts of {1:g} m/s must stay below the airspeed, {2} m/s</source>
        <translation>intensidad de turbulencia {0}: las ráfagas de {1:g} m/s deben quedar por debajo de la velocidad aérea, {2} m/s</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/wind.py"/>
        <source>wind direction</source>
        <translation>dirección del viento</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/wind.py"/>
        <source>wind speed</source>
        <translation>velocidad del viento</translation>
    </message>
    <message>
        <location filename="../../core/mission/flight/wind.py"/>
        <source>wind speed {0} m/s: must be below the airspeed, {1} m/s, to fly against it</source>
        <translation>velocidad del viento de {0} m/s: debe ser menor que la velocidad aérea, {1} m/s, para volar contra él</translation>
    </message>
    <message>
        <location filename="../../core/mission/imageries.py"/>
        <source>imagery {0!r}: has no source, such as {0}=world</source>
        <translation>imágenes {0!r}: no tienen fuente, como {0}=world</translation>
    </message>
    <message>
        <location filename="../../core/mission/imageries.py"/>
        <source>imagery {0!r}: is named twice</source>
        <translation>imágenes {0!r}: se nombran dos veces</translation>
    </message>
    <message>
        <location filename="../../core/mission/imageries.py"/>
        <source>imagery {0!r}: is the name of a device on Windows, and of no folder</source>
        <translation>imágenes {0!r}: es el nombre de un dispositivo en Windows, no de una carpeta</translation>
    </message>
    <message>
        <location filename="../../core/mission/imageries.py"/>
        <source>imagery {0!r}: must be named by up to 64 letters, digits, _, - and ., such as 2014</source>
        <translation>imágenes {0!r}: deben nombrarse con hasta 64 letras, cifras, _, - y ., como 2014</translation>
    </message>
    <message>
        <location filename="../../core/mission/imageries.py"/>
        <source>map type {0!r}: must be one of {1}</source>
        <translation>tipo de mapa {0!r}: debe ser uno de {1}</translation>
    </message>
    <message>
        <location filename="../../core/mission/imageries.py"/>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>source {0!r}: holds a NUL character, which no name has</source>
        <translation>fuente {0!r}: contiene un carácter NUL, que ningún nombre tiene</translation>
    </message>
    <message>
        <location filename="../../core/mission/inside.py"/>
        <source>choose another area, or lower flights</source>
        <translation>elija otra zona o vuelos más bajos</translation>
    </message>
    <message>
        <location filename="../../core/mission/inside.py"/>
        <source>give points</source>
        <translation>indique puntos</translation>
    </message>
    <message>
        <location filename="../../core/mission/inside.py"/>
        <source>images within the imagery: cannot be selected for an area over relief, in wind or with random poses</source>
        <translation>imágenes dentro de las disponibles: no se pueden seleccionar en una zona con relieve, con viento o con poses al azar</translation>
    </message>
    <message>
        <location filename="../../core/mission/inside.py"/>
        <source>none of the {0:,} images lies within the imagery</source>
        <translation>ninguna de las {0:,} imágenes queda dentro de las disponibles</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/framing.py"/>
        <source>ask for that or more, or allow upsampling ({0})</source>
        <translation>pida ese o más, o permita el sobremuestreo ({0})</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/framing.py"/>
        <source>ask for that, or allow upsampling ({0})</source>
        <translation>pida ese, o permita el sobremuestreo ({0})</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/framing.py"/>
        <source>choose a larger ground sample distance</source>
        <translation>elija una distancia de muestreo del terreno mayor</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/framing.py"/>
        <source>choose a less extreme aspect ratio or a larger image ({0})</source>
        <translation>elija una relación de aspecto menos extrema o una imagen mayor ({0})</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/framing.py"/>
        <source>choose a less extreme aspect ratio or larger images ({0})</source>
        <translation>elija una relación de aspecto menos extrema o permita imágenes mayores ({0})</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/framing.py"/>
        <source>choose a lower zoom</source>
        <translation>elija un zoom menor</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/framing.py"/>
        <source>fly higher or choose a higher zoom</source>
        <translation>vuele más alto o elija un zoom mayor</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/framing.py"/>
        <source>fly higher or choose a smaller ground sample distance</source>
        <translation>vuele más alto o elija una distancia de muestreo del terreno menor</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/framing.py"/>
        <source>fly higher or nearer to the equator, or choose imagery in a polar CRS</source>
        <translation>vuele más alto o más cerca del ecuador, o elija imágenes en un SRC polar</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/framing.py"/>
        <location filename="../../core/mission/layout/rows.py"/>
        <source>fly lower</source>
        <translation>vuele más bajo</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/framing.py"/>
        <source>fly lower or nearer to the equator, or choose imagery in a polar CRS</source>
        <translation>vuele más bajo o más cerca del ecuador, o elija imágenes en un SRC polar</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/framing.py"/>
        <source>ground sample distance {0} m: the source's own pixels are {1:.3g} m here</source>
        <translation>distancia de muestreo del terreno de {0} m: los píxeles propios de la fuente son aquí de {1:.3g} m</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/framing.py"/>
        <source>image at latitude {0!r} from {1:g} m</source>
        <translation>imagen en la latitud {0!r} desde {1:g} m</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/framing.py"/>
        <source>image from {0:g} m at zoom {1}: under one pixel</source>
        <translation>imagen desde {0:g} m con zoom {1}: menos de un píxel</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/framing.py"/>
        <source>image of {0:.3g} x {1:.3g} px: under one pixel</source>
        <translation>imagen de {0:.3g} x {1:.3g} px: menos de un píxel</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/framing.py"/>
        <source>images of {0:,} px: the longest side allowed here is {1:,} px</source>
        <translation>imágenes de {0:,} px: el lado mayor permitido aquí es de {1:,} px</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/framing.py"/>
        <source>images of {0:,} x {1:,} px: {2:,} px in all are allowed</source>
        <translation>imágenes de {0:,} x {1:,} px: se permiten {2:,} px en total</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/framing.py"/>
        <source>zoom {0}: the source has {1} to {2}</source>
        <translation>zoom {0}: la fuente tiene de {1} a {2}</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/framing.py"/>
        <source>zoom {0}: the source's own pixels end at zoom {1}</source>
        <translation>zoom {0}: los píxeles propios de la fuente terminan en el zoom {1}</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/framing.py"/>
        <source>{0}, or allow larger images ({1})</source>
        <translation>{0}, o permitir imágenes mayores ({1})</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/framing.py"/>
        <source>{0}, or make them smaller ({1})</source>
        <translation>{0}, o hacerlas más pequeñas ({1})</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/framing.py"/>
        <source>{0}: lies beyond the map, which ends at ±{1:.4f}</source>
        <translation>{0}: queda fuera del mapa, que termina en ±{1:.4f}</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/framing.py"/>
        <source>{0}: reaches beyond the map, which ends at ±{1:.4f}</source>
        <translation>{0}: sobrepasa el mapa, que termina en ±{1:.4f}</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/no_fly.py"/>
        <source>all {0:,} images lie over no-fly areas</source>
        <translation>las {0:,} imágenes están sobre zonas de exclusión</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/no_fly.py"/>
        <source>choose another area, or smaller no-fly areas</source>
        <translation>elija otra área, o zonas de exclusión más pequeñas</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/paper.py"/>
        <source>camera facing {0}</source>
        <translation>cámara que mira a {0}</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/paper.py"/>
        <source>margin {0:g} m</source>
        <translation>margen de {0:g} m</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/paper.py"/>
        <source>paper layout over {0:g} deg of longitude: its UTM grid holds to {1:g} deg from the zone's meridian</source>
        <translation>disposición paper en {0:g} grados de longitud: su cuadrícula UTM vale hasta {1:g} grados del meridiano del huso</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/paper.py"/>
        <source>{0}: the layout {1} does not support it</source>
        <translation>{0}: la disposición {1} no lo admite</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/parallels.py"/>
        <source>a camera at {0:g} m with this tilt sees the area from nowhere on the map</source>
        <translation>una cámara a {0:g} m con esta inclinación no ve el área desde ningún lugar del mapa</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/parallels.py"/>
        <source>fly lower or farther from it</source>
        <translation>vuele más bajo o más lejos de él</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/parallels.py"/>
        <source>fly lower or take a smaller area</source>
        <translation>vuele más bajo o tome un área menor</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/parallels.py"/>
        <source>points have no rows, and several polygons have rows each by themselves</source>
        <translation>los puntos no tienen filas, y de varios polígonos cada uno tiene las suyas</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/parallels.py"/>
        <source>rows from {0:g} m cannot be placed so near to a pole</source>
        <translation>no se pueden situar pasadas desde {0:g} m tan cerca de un polo</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/parallels.py"/>
        <source>rows from {0:g} m cannot be placed so that their images cover this area</source>
        <translation>no se pueden situar pasadas desde {0:g} m de modo que sus imágenes cubran este área</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/parallels.py"/>
        <location filename="../../core/mission/layout/rotated.py"/>
        <location filename="../../core/mission/layout/rows.py"/>
        <source>tilt it less or fly lower</source>
        <translation>inclínela menos o vuele más bajo</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/parallels.py"/>
        <source>tilt the camera less, fly lower or take a smaller area</source>
        <translation>incline menos la cámara, vuele más bajo o tome un área menor</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/polygons.py"/>
        <source>layout {0}: lays one grid over one polygon, and there are {1:,}</source>
        <translation>disposición {0}: traza una sola cuadrícula sobre un polígono, y hay {1:,}</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/rotated.py"/>
        <source>area: the source's CRS {0} does not reach latitude {1!r}, longitude {2!r}</source>
        <translation>área: el SRC {0} de la fuente no alcanza la latitud {1!r}, longitud {2!r}</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/rotated.py"/>
        <source>camera from {0:g} m: sees past the horizon, where turned rows have no frames</source>
        <translation>cámara desde {0:g} m: ve más allá del horizonte, donde las pasadas giradas no tienen encuadres</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/rotated.py"/>
        <source>camera with tilt {0:g}, roll {1:g} deg from {2:g} m: sees past the horizon, and an area is covered by images of ground alone on a source that has its own CRS</source>
        <translation>cámara con inclinación {0:g}, alabeo {1:g} grados desde {2:g} m: ve más allá del horizonte, y en una fuente con SRC propio un área se cubre solo con imágenes de terreno</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/rotated.py"/>
        <source>camera with tilt {0:g}, roll {1:g} deg from {2:g} m: sees past the horizon, where rows flown to and fro have no frames that face their track</source>
        <translation>cámara con inclinación de {0:g} y alabeo de {1:g} grados desde {2:g} m: ve más allá del horizonte, donde las pasadas de ida y vuelta no tienen encuadres en el sentido de vuelo</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/rotated.py"/>
        <source>camera with tilt {0:g}, roll {1:g} deg from {2:g} m: sees past the horizon, where turned rows have no frames</source>
        <translation>cámara con inclinación {0:g}, alabeo {1:g} grados desde {2:g} m: ve más allá del horizonte, donde las pasadas giradas no tienen encuadres</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/rotated.py"/>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>crosshatch</source>
        <translation>cuadrícula cruzada</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/rotated.py"/>
        <source>fly lower or fly north-up rows</source>
        <translation>vuele más bajo o vuele pasadas con el norte arriba</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/rotated.py"/>
        <source>layout {0}: lies on the Web-Mercator map, and the source has pixels of its own in {1}</source>
        <translation>disposición {0}: está en el mapa Web Mercator, y la fuente tiene píxeles propios en {1}</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/rotated.py"/>
        <source>points have no rows that could be turned, and several polygons each their own</source>
        <translation>los puntos no tienen pasadas que se puedan girar, y varios polígonos tienen cada uno las suyas</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/rotated.py"/>
        <source>row azimuth {0:g} deg</source>
        <translation>acimut de las pasadas de {0:g} grados</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/rotated.py"/>
        <source>row azimuth {0:g} deg: turned rows hold to {1:g} km from the area's middle, and the area or its images reach {2:.4g} km</source>
        <translation>acimut de las pasadas de {0:g} grados: las pasadas giradas valen hasta {1:g} km del centro del área, y el área o sus imágenes llegan a {2:.4g} km</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/rotated.py"/>
        <source>take a smaller area or north-up rows</source>
        <translation>tome un área menor o pasadas con el norte arriba</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/rotated.py"/>
        <source>tilt it less, fly lower or fly north-up rows</source>
        <translation>inclínela menos, vuele más bajo o vuele pasadas con el norte arriba</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/rotated.py"/>
        <source>{0}: the layout {1} is north-up</source>
        <translation>{0}: la disposición {1} tiene el norte arriba</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/rows.py"/>
        <source>area reaches latitude {0}: images end at ±{1:.4f} (Web Mercator)</source>
        <translation>el área llega a la latitud {0}: las imágenes terminan en ±{1:.4f} (Web Mercator)</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/rows.py"/>
        <source>choose imagery in a polar CRS, such as the synthetic world with {0} {1}</source>
        <translation>elija imágenes en un SRC polar, como el mundo sintético con {0} {1}</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/rows.py"/>
        <source>fly higher, draw a smaller area, or raise it ({0})</source>
        <translation>vuele más alto, dibuje un área menor, o súbalo ({0})</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/rows.py"/>
        <source>images with under 0.001 px of map in them: the camera looks past the map or the Earth</source>
        <translation>imágenes con menos de 0,001 px de mapa: la cámara mira más allá del mapa o de la Tierra</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/rows.py"/>
        <source>mission of {0:,.0f} images: the limit is {1:,}</source>
        <translation>misión de {0:,.0f} imágenes: el límite es {1:,}</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/rows.py"/>
        <source>overlap less</source>
        <translation>solapar menos</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/rows.py"/>
        <source>overlap {0}: leaves under 0.001 px between captures</source>
        <translation>solape {0}: deja menos de 0,001 px entre capturas</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/rows.py"/>
        <source>rows cover an area</source>
        <translation>las filas cubren un área</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/skipped.py"/>
        <source>skipped rows {0}: no row is left</source>
        <translation>pasadas omitidas {0}: no queda ninguna pasada</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/skipped.py"/>
        <source>skipped rows {0}: points have no rows</source>
        <translation>pasadas omitidas {0}: los puntos no tienen pasadas</translation>
    </message>
    <message>
        <location filename="../../core/mission/layout/skipped.py"/>
        <source>skipped rows {0}: the rows of this mission are 0 to {1:,}</source>
        <translation>pasadas omitidas {0}: las pasadas de esta misión van de 0 a {1:,}</translation>
    </message>
    <message>
        <location filename="../../core/mission/litchi_table.py"/>
        <source>{0} images each {1:g} m: must be {2:,} in all or fewer</source>
        <translation>{0} imágenes cada {1:g} m: deben ser {2:,} en total o menos</translation>
    </message>
    <message>
        <location filename="../../core/mission/litchi_table.py"/>
        <source>{0} its height of {1:g} m is above the take-off (altitudemode {2}): must be above the ground (1)</source>
        <translation>{0} su altura de {1:g} m es sobre el despegue (altitudemode {2}): debe ser sobre el terreno (1)</translation>
    </message>
    <message>
        <location filename="../../core/mission/litchi_table.py"/>
        <source>{0}, waypoint {1}:</source>
        <translation>{0}, punto de paso {1}:</translation>
    </message>
    <message>
        <location filename="../../core/mission/litchi_table.py"/>
        <source>{0}: cannot be read as a table ({1})</source>
        <translation>{0}: no se puede leer como tabla ({1})</translation>
    </message>
    <message>
        <location filename="../../core/mission/litchi_table.py"/>
        <location filename="../../core/mission/pose_table.py"/>
        <source>{0}: holds no poses below its header</source>
        <translation>{0}: no contiene poses bajo su cabecera</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <source>a map frame shows the source's own pixels</source>
        <translation>un encuadre de mapa muestra los propios píxeles de la fuente</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <source>air without gusts was asked for</source>
        <translation>se pidió aire sin ráfagas</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <source>choose a source of tiles</source>
        <translation>elija una fuente de teselas</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <source>condition number</source>
        <translation>número de condición</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <source>each image has a lens of its own, which windows of a map do not</source>
        <translation>cada imagen tiene su propia lente, y las ventanas de un mapa no</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <source>error</source>
        <translation>error</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <source>error budget {0:g} px: no methods fit; the closest are {1} with {2} px, {3} times as much</source>
        <translation>error admisible de {0:g} px: ningún método cabe; los más próximos son {1} con {2} px, {3} veces más</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <source>fly higher or widen the field of view</source>
        <translation>vuele más alto o amplíe el campo de visión</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <source>footprint</source>
        <translation>huella</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <source>image 'map' was asked for, but has no bound here: {0}</source>
        <translation>se pidió la imagen 'map', pero aquí no tiene cota: {0}</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <source>image as the camera sees it: {0}</source>
        <translation>imagen como la ve la cámara: {0}</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <source>images are turned at random</source>
        <translation>las imágenes están giradas al azar</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <source>infinite (horizon)</source>
        <translation>infinito (horizonte)</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <source>its bound of {0} px and {1} px of the other stages exceed the budget of {2:g} px</source>
        <translation>su cota de {0} px y los {1} px de los demás pasos superan los {2:g} px admisibles</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <location filename="../../core/poses/settings.py"/>
        <source>left out</source>
        <translation>se omite</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <source>method of {0}</source>
        <translation>método: {0}</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <source>not bounded, up to {0:.2g} px per metre of relief</source>
        <translation>sin cota, hasta {0:.2g} px por metro de relieve</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <source>not bounded, without limit at the horizon</source>
        <translation>sin cota, sin límite en el horizonte</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <source>nothing</source>
        <translation>nada</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <source>pixels</source>
        <translation>píxeles</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <source>pixels of {0:.2g} m on the ground: degrees in float64 resolve {1:g} m</source>
        <translation>píxeles de {0:.2g} m sobre el terreno: los grados en float64 distinguen {1:g} m</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <source>raise {0}, or go on with {1}</source>
        <translation>suba {0}, o siga con {1}</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <location filename="../../core/report/measure.py"/>
        <source>rays for every pixel</source>
        <translation>rayos para cada píxel</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <location filename="../../core/mission/parts/pictures.py"/>
        <location filename="../../core/report/measure.py"/>
        <source>resampling</source>
        <translation>remuestreo</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <source>still air was asked for</source>
        <translation>se pidió aire en calma</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <source>terrain</source>
        <translation>relieve</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <source>the camera moves on while an image is taken</source>
        <translation>la cámara sigue moviéndose mientras se toma una imagen</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <source>the ground is from {0:.1f} to {1:.1f} m high, and seen from aside</source>
        <translation>el terreno tiene de {0:.1f} a {1:.1f} m de altura y se ve de lado</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <source>the lens distorts images, which windows of a map do not</source>
        <translation>el objetivo distorsiona las imágenes, y los recortes de un mapa no</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <source>the mesh's bound of {0} px fits</source>
        <translation>la cota de la malla, {0} px, cabe</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <source>the rows are turned from east, and the camera with them</source>
        <translation>las pasadas están giradas respecto al este, y la cámara con ellas</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <location filename="../../core/report/measure.py"/>
        <source>the source gives images by their centre, not tiles that others can be made from</source>
        <translation>la fuente da imágenes por su centro, no teselas con las que se puedan hacer otras</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <source>wind turns the camera</source>
        <translation>el viento gira la cámara</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <source>{0}, ≤ {1} px</source>
        <translation>{0}, ≤ {1} px</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <source>{0}, ≤ {1} px (not {2}: {3})</source>
        <translation>{0}, ≤ {1} px (no {2}: {3})</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <source>{0}; up to {1:.2g} px per metre that its heights are off</source>
        <translation>{0}; hasta {1:.2g} px por cada metro de error de sus alturas</translation>
    </message>
    <message>
        <location filename="../../core/mission/methods.py"/>
        <source>≤ {0} px of a budget of {1:g} px</source>
        <translation>≤ {0} px de {1:g} px admisibles</translation>
    </message>
    <message>
        <location filename="../../core/mission/mission.py"/>
        <source>area type {0!r}: must be box, polygon, polygons or points</source>
        <translation>tipo de área {0!r}: debe ser box, polygon, polygons o points</translation>
    </message>
    <message>
        <location filename="../../core/mission/mission.py"/>
        <source>blur by motion: needs a stated exposure time, and a meter sets it</source>
        <translation>desenfoque por movimiento: necesita un tiempo de exposición fijo, y lo elige un exposímetro</translation>
    </message>
    <message>
        <location filename="../../core/mission/mission.py"/>
        <source>blur by motion: needs an exposure time</source>
        <translation>desenfoque por movimiento: necesita un tiempo de exposición</translation>
    </message>
    <message>
        <location filename="../../core/mission/mission.py"/>
        <source>choose a lens with distortion, or leave them out</source>
        <translation>elija un objetivo con distorsión, o prescinda de ellas</translation>
    </message>
    <message>
        <location filename="../../core/mission/mission.py"/>
        <source>choose another exposure{0}</source>
        <translation>elija otra exposición{0}</translation>
    </message>
    <message>
        <location filename="../../core/mission/mission.py"/>
        <source>diffraction: needs the pixel pitch</source>
        <translation>difracción: requiere el paso de píxel</translation>
    </message>
    <message>
        <location filename="../../core/mission/mission.py"/>
        <source>exposure {0}: needs an exposure time</source>
        <translation>exposición {0}: necesita un tiempo de exposición</translation>
    </message>
    <message>
        <location filename="../../core/mission/mission.py"/>
        <location filename="../../core/mission/parts/sensor.py"/>
        <location filename="../../core/mission/sunlight.py"/>
        <source>give it{0}</source>
        <translation>indíquelo{0}</translation>
    </message>
    <message>
        <location filename="../../core/mission/mission.py"/>
        <source>give one{0}</source>
        <translation>indique uno{0}</translation>
    </message>
    <message>
        <location filename="../../core/mission/mission.py"/>
        <source>mission field {0!r} is {1!r}: must be a list of polygons</source>
        <translation>el campo {0!r} de la misión es {1!r}: debe ser una lista de polígonos</translation>
    </message>
    <message>
        <location filename="../../core/mission/mission.py"/>
        <source>mission field {0!r} is {1!r}: must be an object</source>
        <translation>el campo de misión {0!r} es {1!r}: debe ser un objeto</translation>
    </message>
    <message>
        <location filename="../../core/mission/mission.py"/>
        <source>mission field {0!r}: not one of {1}</source>
        <translation>campo de misión {0!r}: no es ninguno de {1}</translation>
    </message>
    <message>
        <location filename="../../core/mission/mission.py"/>
        <source>mission file {0}: cannot be read ({1})</source>
        <translation>archivo de misión {0}: no se puede leer ({1})</translation>
    </message>
    <message>
        <location filename="../../core/mission/mission.py"/>
        <source>mission file {0}: holds no mission, which is a JSON object; a file of places is given as coordinates</source>
        <translation>archivo de misión {0}: no contiene una misión, que es un objeto JSON; un archivo de lugares se indica como coordenadas</translation>
    </message>
    <message>
        <location filename="../../core/mission/mission.py"/>
        <source>mission is a JSON {0}: must be an object</source>
        <translation>la misión es un {0} de JSON: debe ser un objeto</translation>
    </message>
    <message>
        <location filename="../../core/mission/mission.py"/>
        <source>mission is not JSON that can be read: {0}</source>
        <translation>la misión no es JSON que se pueda leer: {0}</translation>
    </message>
    <message>
        <location filename="../../core/mission/mission.py"/>
        <source>mission schema {0!r}: this version reads schema {1}</source>
        <translation>esquema de misión {0!r}: esta versión lee el esquema {1}</translation>
    </message>
    <message>
        <location filename="../../core/mission/mission.py"/>
        <source>mission with a value of the wrong type: {0}</source>
        <translation>misión con un valor de tipo erróneo: {0}</translation>
    </message>
    <message>
        <location filename="../../core/mission/mission.py"/>
        <source>mission without {0}.{1}: the field is needed</source>
        <translation>misión sin {0}.{1}: el campo es necesario</translation>
    </message>
    <message>
        <location filename="../../core/mission/mission.py"/>
        <source>mission without {0}: the field is needed</source>
        <translation>misión sin {0}: el campo es necesario</translation>
    </message>
    <message>
        <location filename="../../core/mission/mission.py"/>
        <source>name one{0}</source>
        <translation>nombre uno{0}</translation>
    </message>
    <message>
        <location filename="../../core/mission/mission.py"/>
        <source>name vector layers{0}</source>
        <translation>indique capas vectoriales{0}</translation>
    </message>
    <message>
        <location filename="../../core/mission/mission.py"/>
        <source>product {0}: has the pixels of the sensor, of which resized images have none</source>
        <translation>producto {0}: tiene los píxeles del sensor, que no quedan en imágenes redimensionadas</translation>
    </message>
    <message>
        <location filename="../../core/mission/mission.py"/>
        <source>product {0}: needs an image sensor</source>
        <translation>producto {0}: necesita un sensor de imagen</translation>
    </message>
    <message>
        <location filename="../../core/mission/mission.py"/>
        <source>product {0}: needs labels or buildings</source>
        <translation>producto {0}: necesita etiquetas o edificios</translation>
    </message>
    <message>
        <location filename="../../core/mission/mission.py"/>
        <source>resampling {0}: must be bilinear for sampling {1}</source>
        <translation>remuestreo {0}: debe ser bilinear para el muestreo {1}</translation>
    </message>
    <message>
        <location filename="../../core/mission/mission.py"/>
        <source>undistorted images: the lens does not distort, so they would be the images themselves</source>
        <translation>imágenes sin distorsión: el objetivo no distorsiona, así que serían las propias imágenes</translation>
    </message>
    <message>
        <location filename="../../core/mission/options.py"/>
        <source>{0} {1!r}: must be true or false</source>
        <translation>{0} {1!r}: debe ser verdadero o falso</translation>
    </message>
    <message>
        <location filename="../../core/mission/options.py"/>
        <source>{0} {1} {2!r}: must be a {3}</source>
        <translation>{0} {1} {2!r}: debe ser {3}</translation>
    </message>
    <message>
        <location filename="../../core/mission/options.py"/>
        <source>{0} {1} {2!r}: must be one of {3}</source>
        <translation>{0} {1} {2!r}: debe ser uno de {3}</translation>
    </message>
    <message>
        <location filename="../../core/mission/options.py"/>
        <source>{0} {1} {2!r}: takes {3} value{4}</source>
        <translation>{0} {1} {2!r}: lleva {3} valores{4}</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/air.py"/>
        <source>airlight</source>
        <translation>luz del aire</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/air.py"/>
        <source>airlight {0!r}: must be red, green and blue from 0 to 255, such as 188 196 204</source>
        <translation>luz del aire {0!r}: debe ser rojo, verde y azul de 0 a 255, como 188 196 204</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/air.py"/>
        <source>colour of haze without end, and of the sky: red, green and blue from 0 to 255</source>
        <translation>color de la bruma sin fin y del cielo: rojo, verde y azul de 0 a 255</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/air.py"/>
        <source>distance at which 5 percent of the contrast of dark things is left (meteorological optical range): haze by the distance of what each pixel shows; left out, the air is clear</source>
        <translation>distancia a la que queda el 5 por ciento del contraste de lo oscuro (alcance óptico meteorológico): bruma según la distancia de lo que muestra cada píxel; si se omite, el aire es claro</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/air.py"/>
        <source>visibility</source>
        <translation>visibilidad</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/exposure.py"/>
        <source>Automatic ISO</source>
        <translation>ISO automático</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/exposure.py"/>
        <source>Automatic exposure time</source>
        <translation>Tiempo de exposición automático</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/exposure.py"/>
        <source>Average</source>
        <translation>Media</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/exposure.py"/>
        <source>Filmic</source>
        <translation>De película</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/exposure.py"/>
        <source>Highlights</source>
        <translation>Altas luces</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/exposure.py"/>
        <source>Ideal (as the imagery)</source>
        <translation>Ideal (como las imágenes de origen)</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/exposure.py"/>
        <source>Linear</source>
        <translation>Lineal</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/exposure.py"/>
        <source>Manual</source>
        <translation>Manual</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/exposure.py"/>
        <source>brightness of the images: ideal, as the imagery has it; manual, by exposure time, f-number and ISO speed in the light of the scene; time or iso, as a meter sets the exposure time or the ISO speed</source>
        <translation>brillo de las imágenes: ideal, el de las imágenes de origen; manual, según el tiempo de exposición, el número f y la sensibilidad ISO con la luz de la escena; time o iso, según un exposímetro fije el tiempo de exposición o la sensibilidad ISO</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/exposure.py"/>
        <source>colour temperature that the camera takes for white, of a scene in daylight of 6,504 K: lower ones make images blue, higher ones yellow; left out, it suits the scene</source>
        <translation>temperatura de color que la cámara toma por blanca, con la escena en luz de día de 6504 K: las más bajas vuelven azules las imágenes, las más altas amarillas; si se omite, la de la escena</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/exposure.py"/>
        <source>curve from light to values: srgb, that of the imagery; linear, none; filmic, with soft shadows and highlights</source>
        <translation>curva de la luz a los valores: srgb, la de las imágenes de origen; linear, ninguna; filmic, con sombras y altas luces suaves</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/exposure.py"/>
        <source>exposure</source>
        <translation>exposición</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/exposure.py"/>
        <source>f-number</source>
        <translation>número f</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/exposure.py"/>
        <source>focal length over the diameter of the aperture</source>
        <translation>distancia focal entre el diámetro de la apertura</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/exposure.py"/>
        <source>highest sensitivity (ISO)</source>
        <translation>sensibilidad máxima (ISO)</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/exposure.py"/>
        <source>illuminance</source>
        <translation>iluminancia</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/exposure.py"/>
        <source>light that falls on the scene: sunlight has 80,000 lx or more, an overcast sky about 10,000 lx</source>
        <translation>luz que cae sobre la escena: el sol da 80 000 lx o más, un cielo cubierto unos 10 000 lx</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/exposure.py"/>
        <source>limit of the automatic ISO</source>
        <translation>límite del ISO automático</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/exposure.py"/>
        <source>limit of the automatic exposure time</source>
        <translation>límite del tiempo de exposición automático</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/exposure.py"/>
        <source>longest exposure time</source>
        <translation>tiempo de exposición máximo</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/exposure.py"/>
        <source>metering</source>
        <translation>medición</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/exposure.py"/>
        <source>sRGB</source>
        <translation>sRGB</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/exposure.py"/>
        <source>sensitivity (ISO)</source>
        <translation>sensibilidad (ISO)</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/exposure.py"/>
        <source>sensitivity ISO {0:g}: must be at most the highest one, ISO {1:g}</source>
        <translation>sensibilidad ISO {0:g}: debe ser como mucho la máxima, ISO {1:g}</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/exposure.py"/>
        <source>sensitivity of the camera, after ISO 12232: exposures of 78/ISO lux seconds saturate it; with automatic ISO, its lowest</source>
        <translation>sensibilidad de la cámara, según ISO 12232: la saturan exposiciones de 78/ISO lux segundo; con ISO automático, la mínima</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/exposure.py"/>
        <source>shortest exposure time</source>
        <translation>tiempo de exposición mínimo</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/exposure.py"/>
        <source>shortest exposure time {0:g} ms: must be at most the longest one, {1:g} ms</source>
        <translation>tiempo de exposición mínimo {0:g} ms: debe ser como mucho el máximo, {1:g} ms</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/exposure.py"/>
        <source>tone curve</source>
        <translation>curva de tono</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/exposure.py"/>
        <source>what automatic exposure meters: average brings the mean of the logarithms of luminance to 18 percent of saturation; highlights lets the brightest percent of the pixels saturate</source>
        <translation>lo que mide la exposición automática: average lleva la media de los logaritmos de la luminancia al 18 por ciento de la saturación; highlights deja que se sature el uno por ciento más brillante de los píxeles</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/exposure.py"/>
        <source>white balance</source>
        <translation>balance de blancos</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>As laid out</source>
        <translation>Según la disposición</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>At each waypoint</source>
        <translation>En cada punto de ruta</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>By distance along rows</source>
        <translation>Por distancia a lo largo de las pasadas</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>Cover (no gaps)</source>
        <translation>Cubrir (sin huecos)</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>DJI Fly (Mini 4 Pro, Air 3, Mavic 3)</source>
        <translation>DJI Fly (Mini 4 Pro, Air 3, Mavic 3)</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>Hover and capture</source>
        <translation>Detenerse y capturar</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>M30</source>
        <translation>M30</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>M300 RTK (P1)</source>
        <translation>M300 RTK (P1)</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>M30T</source>
        <translation>M30T</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>M350 RTK (P1)</source>
        <translation>M350 RTK (P1)</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>M4E</source>
        <translation>M4E</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>M4T</source>
        <translation>M4T</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>Mavic 3E</source>
        <translation>Mavic 3E</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>Mavic 3M</source>
        <translation>Mavic 3M</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>Mavic 3T</source>
        <translation>Mavic 3T</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>Nearest to take-off</source>
        <translation>La más cercana al despegue</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>North-east</source>
        <translation>Noreste</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>North-west</source>
        <translation>Noroeste</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>One way</source>
        <translation>Un solo sentido</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>Paper (UTM grid)</source>
        <translation>Artículo (cuadrícula UTM)</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>Serpentine (to and fro)</source>
        <translation>En zigzag (ida y vuelta)</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>South-east</source>
        <translation>Sureste</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>South-west</source>
        <translation>Suroeste</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>airspeed</source>
        <translation>velocidad aérea</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>battery</source>
        <translation>batería</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>battery of {0:g} min: needs a take-off point, where each sortie begins and ends</source>
        <translation>batería de {0:g} min: necesita un punto de despegue, donde empieza y termina cada salida</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>camera faces</source>
        <translation>la cámara mira a</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>camera faces {0!r}: must be {1}, {2} or an azimuth from -360 to 360</source>
        <translation>la cámara mira a {0!r}: debe ser {1}, {2} o un acimut de -360 a 360</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>capture time of the first image, in UTC as 2024-06-21T10:30:00Z; the clock of the simulated flight starts then</source>
        <translation>hora de captura de la primera imagen, en UTC como 2024-06-21T10:30:00Z; entonces arranca el reloj del vuelo simulado</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>corner of the rows where the flight begins; for rotated rows the corner nearest to that direction. first: as the rows are laid out; nearest: the corner nearest to the take-off. Points keep their order</source>
        <translation>esquina de las pasadas por la que empieza el vuelo; en pasadas giradas, la más cercana a esa dirección. first: según la disposición de las pasadas; nearest: la esquina más cercana al despegue. Los puntos conservan su orden</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>cover: rows without gaps; paper: the UTM grid of the published paper</source>
        <translation>cubrir: pasadas sin huecos; artículo: la cuadrícula UTM del artículo publicado</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>direction of an area's rows, clockwise from north: 90 flies them east; not for points</source>
        <translation>dirección de las pasadas de un área, en sentido horario desde el norte: con 90 se vuelan hacia el este; los puntos no tienen</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>direction of the image's top edge, clockwise from north, or from grid north of the source's CRS; images turn with rotated rows, and points may state other yaws</source>
        <translation>dirección del borde superior de la imagen, en sentido horario desde el norte; si las pasadas se apartan del este, gira con ellas; si la fuente tiene SRC propio, se cuenta desde el norte de la cuadrícula; los puntos pueden tener guiñadas propias</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>direction of the top of the images, to which the yaw is added: north, which turns with rotated rows; track, the flight direction of each row; or an azimuth in degrees, the same for all images</source>
        <translation>hacia dónde apunta el borde superior de las imágenes, desde donde se cuenta la guiñada: north, girado con las pasadas donde estas se apartan del este; track, el sentido en que se vuela cada pasada; o un acimut en grados, el mismo para todas las imágenes</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>distance flown beyond the end of each row before the turn</source>
        <translation>cuánto sigue el vuelo más allá del final de cada pasada antes de girar</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>distance flown on the line of each row before its first capture</source>
        <translation>cuánto antes de la primera captura de cada pasada vuela ya en línea con ella</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>drone</source>
        <translation>dron</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>drone for DJI files (.kmz); M300 and M350 with the camera P1; dji-fly for drones that use DJI Fly, such as Mini 4 Pro, Air 3 and Mavic 3</source>
        <translation>dron al que se destina un archivo de los programas de DJI (.kmz); M300 y M350 son los que llevan la cámara P1, y dji-fly representa los drones que vuela DJI Fly, como Mini 4 Pro, Air 3 y Mavic 3</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>each image of an area has a yaw at random, by the seed, and rows are as close as that takes; not for tilted cameras, nor for points, which state their yaws</source>
        <translation>cada imagen de un área tiene una guiñada al azar, según la semilla, y las pasadas están tan juntas como haga falta; no para cámaras inclinadas ni para puntos, que indican sus guiñadas</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>entry</source>
        <translation>entrada</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>entry nearest: needs a take-off point to be near to</source>
        <translation>entrada nearest: necesita un punto de despegue del que estar cerca</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>exposure time</source>
        <translation>tiempo de exposición</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>flight time of one battery, without the reserve: the flight is split into sorties that begin and end at the take-off</source>
        <translation>tiempo de vuelo de una batería, sin contar la reserva: el vuelo se divide en salidas que empiezan y terminan en el despegue</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>fly the area a second time, in rows across the first: about twice as many images</source>
        <translation>volar el área por segunda vez, en pasadas que cruzan las primeras: cerca del doble de imágenes</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>greatest motion blur</source>
        <translation>mayor desenfoque de movimiento</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>greatest motion of the ground in an image during the exposure time, straight below the camera</source>
        <translation>mayor movimiento del terreno en una imagen durante el tiempo de exposición, justo debajo de la cámara</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <location filename="../../core/poses/settings.py"/>
        <source>ground height</source>
        <translation>altura del terreno</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>height above gro&amp;und</source>
        <translation>altura sobre el terre&amp;no</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <location filename="../../core/poses/settings.py"/>
        <source>height above ground</source>
        <translation>altura sobre el terreno</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>height of the captures above ground (AGL); coordinates and points may state other heights</source>
        <translation>altura de las capturas sobre el terreno (AGL); las coordenadas y los puntos con alturas llevan la suya</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>height of the ground above the WGS84 ellipsoid</source>
        <translation>altura del terreno sobre el elipsoide WGS84</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>how far the camera is turned last, after yaw and tilt, about where the image's top edge points: right side down</source>
        <translation>cuánto gira la cámara al final, tras la guiñada y la inclinación, en torno a la dirección a la que apunta el borde superior de la imagen: lado derecho hacia abajo</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>how far the view is lifted from straight down towards the image's top edge; 90 looks level</source>
        <translation>cuánto se levanta la vista desde la vertical hacia el borde superior de la imagen; 90 mira al horizonte</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>la&amp;yout</source>
        <translation>&amp;disposición</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>latitude and longitude where the flight begins and ends; left out, it goes from the first capture to the last</source>
        <translation>latitud y longitud del lugar donde empieza y termina el vuelo; si se omite, el vuelo va de la primera captura a la última</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>layout</source>
        <translation>disposición</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>lead-in</source>
        <translation>tramo de entrada</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>margin</source>
        <translation>margen</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>minimum image interval</source>
        <translation>intervalo mínimo de imágenes</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>numbers of images in flight order, from 1, after which the aircraft lands at the take-off and a new sortie begins, such as 120,340; each part is split further where the battery requires it</source>
        <translation>números de imágenes en el orden de vuelo, desde 1, tras las que la aeronave aterriza en el despegue y empieza otra salida, como 120,340; cada parte se divide más donde la batería lo exige</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>order of rows</source>
        <translation>orden de las pasadas</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>random yaw</source>
        <translation>guiñada al azar</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>roll</source>
        <translation>alabeo</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>row azimuth</source>
        <translation>acimut de las pasadas</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>rows of an area that are not flown, by their numbers in the names of images, such as 3,7-9: the other images keep their names; not for points</source>
        <translation>pasadas de un área que no se vuelan, por sus números en los nombres de las imágenes, como 3,7-9: las demás imágenes conservan sus nombres; no para puntos</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>serpentine: every other row is flown back; one-way: every row is flown from its beginning</source>
        <translation>en zigzag: una de cada dos pasadas se vuela de vuelta; un solo sentido: cada pasada se vuela desde su comienzo</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>set a take-off point{0}</source>
        <translation>indique un punto de despegue{0}</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>share of an image that the next one in its row also shows</source>
        <translation>parte de una imagen que la siguiente de su pasada vuelve a mostrar</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>share of an image that the next row also shows</source>
        <translation>parte de una imagen que la pasada siguiente vuelve a mostrar</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>shortest time between two images that the camera can sustain</source>
        <translation>el tiempo más corto entre dos imágenes que la cámara puede mantener</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>skipped rows {0!r}: must be numbers and ranges such as 3,7-9</source>
        <translation>pasadas omitidas {0!r}: deben ser números e intervalos como 3,7-9</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>speed of the flight through the air</source>
        <translation>velocidad del vuelo respecto al aire</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>split after</source>
        <translation>dividir tras</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>split after image {0}: needs a take-off point, where each sortie begins and ends</source>
        <translation>división tras la imagen {0}: requiere un punto de despegue, donde empieza y termina cada salida</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>split after {0!r}: must be numbers of images such as 120,340</source>
        <translation>dividir tras {0!r}: deben ser números de imágenes como 120,340</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>split after {0:,} images: a flight has at most {1:,} sorties</source>
        <translation>división tras {0:,} imágenes: un vuelo tiene como máximo {1:,} salidas</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>start</source>
        <translation>inicio</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>start {0!r}: must be UTC as 2024-06-21T10:30:00Z</source>
        <translation>inicio {0!r}: debe ser UTC como 2024-06-21T10:30:00Z</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>start {0!r}: no such time ({1})</source>
        <translation>inicio {0!r}: no existe tal hora ({1})</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>take-off</source>
        <translation>despegue</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>take-off {0}: must be a latitude from -90 to 90 and a longitude from -360 to 360 degrees</source>
        <translation>despegue {0}: debe ser una latitud de -90 a 90 y una longitud de -360 a 360 grados</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <location filename="../../core/poses/settings.py"/>
        <source>tilt</source>
        <translation>inclinación</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>time that the shutter is open; with the greatest motion blur it limits the speed of the flight</source>
        <translation>tiempo que el obturador está abierto; junto con el mayor desenfoque de movimiento limita la velocidad del vuelo</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>trigger</source>
        <translation>disparo</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>turnaround</source>
        <translation>prolongación para el giro</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>waypoint: an image at each waypoint, flown through; distance: the camera is released by the distance flown along each row; hover: the aircraft stops at each waypoint</source>
        <translation>waypoint: una imagen en cada punto de ruta, sin detenerse; distance: la cámara se dispara según la distancia volada en cada pasada; hover: la aeronave se detiene en cada punto de ruta</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>width of the ground around an area that is also covered; not for points</source>
        <translation>anchura del terreno alrededor de un área que también se cubre; los puntos no tienen</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/flown.py"/>
        <source>yaw</source>
        <translation>guiñada</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/labels.py"/>
        <source>field of numbers by which overlapping features of a layer lie on top, the greatest last; by default later features lie on top of earlier ones</source>
        <translation>campo de números según el cual se superponen los objetos de una capa, el mayor encima; por omisión, los objetos posteriores quedan encima de los anteriores</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/labels.py"/>
        <source>label order {0!r}: must be the name of a field, without spaces around it</source>
        <translation>orden de etiquetas {0!r}: debe ser el nombre de un campo, sin espacios alrededor</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/labels.py"/>
        <source>labels</source>
        <translation>etiquetas</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/labels.py"/>
        <source>labels {0!r}: must be a file, FILE:FIELD, FILE:LAYER or FILE:LAYER:FIELD</source>
        <translation>etiquetas {0!r}: debe ser un archivo, ARCHIVO:CAMPO, ARCHIVO:CAPA o ARCHIVO:CAPA:CAMPO</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/labels.py"/>
        <source>labels {0}: each layer may be named once</source>
        <translation>etiquetas {0}: cada capa puede indicarse una vez</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/labels.py"/>
        <source>order of labels</source>
        <translation>orden de las etiquetas</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/labels.py"/>
        <source>radius of points</source>
        <translation>radio de los puntos</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/labels.py"/>
        <source>radius on the ground of labels that are points</source>
        <translation>radio en el terreno de las etiquetas que son puntos</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/labels.py"/>
        <source>vector files whose features give each pixel its class and instance, as FILE, FILE:FIELD, FILE:LAYER or FILE:LAYER:FIELD; the field holds the classes, without one the layer is one class; of several files, later ones lie on top</source>
        <translation>archivos vectoriales cuyos objetos dan a cada píxel su clase y su instancia, como ARCHIVO, ARCHIVO:CAMPO, ARCHIVO:CAPA o ARCHIVO:CAPA:CAMPO; el campo contiene las clases, sin él la capa es una sola clase; de varios archivos, los posteriores quedan encima</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/labels.py"/>
        <source>width of lines</source>
        <translation>anchura de las líneas</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/labels.py"/>
        <source>width on the ground of labels that are lines</source>
        <translation>anchura en el terreno de las etiquetas que son líneas</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/optics.py"/>
        <source>Interpolated</source>
        <translation>Interpolado</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/optics.py"/>
        <source>Mean over the area</source>
        <translation>Media del área</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/optics.py"/>
        <source>blur images by the diffraction of the aperture, from f-number and pixel pitch, for green light of 555 nm</source>
        <translation>desenfocar las imágenes por la difracción de la apertura, según el número f y el paso de píxel, para luz verde de 555 nm</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/optics.py"/>
        <source>diffraction</source>
        <translation>difracción</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/optics.py"/>
        <source>diffraction, and an MTF50 of {0:g} cycles/px, which includes it: must be one of the two</source>
        <translation>difracción y además una MTF50 de {0:g} ciclos/px, que la incluye: debe ser una de las dos</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/optics.py"/>
        <source>how light falls off from the middle of the image: none; cos4, by the fourth power of the cosine of the angle to the optical axis; or up to three coefficients a b c of 1 + a r² + b r⁴ + c r⁶, from 0 to 2, where r is the distance from the principal point, 1 at half the image's diagonal</source>
        <translation>cómo disminuye la luz desde el centro de la imagen: none, nada; cos4, según la cuarta potencia del coseno del ángulo con el eje óptico; o hasta tres coeficientes a b c de 1 + a r² + b r⁴ + c r⁶, de 0 a 2, donde r es la distancia al punto principal, 1 a media diagonal de la imagen</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/optics.py"/>
        <source>how pixels of camera frames are taken from the imagery: zoom interpolates it at the zoom that suits the pixel, and averages up to 8 samples of slanted ground; area averages all that the pixel covers, in linear light, from finer zooms: without aliases far away, with more tiles</source>
        <translation>cómo se toman de las imágenes los píxeles de los cuadros de cámara: zoom interpola en el zoom que conviene al píxel y promedia hasta 8 muestras de terreno inclinado; area promedia todo lo que cubre el píxel, en luz lineal y de zooms más finos: sin aliasing a lo lejos, con más teselas</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/optics.py"/>
        <source>sampling</source>
        <translation>muestreo</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/optics.py"/>
        <source>sharpness (MTF50)</source>
        <translation>nitidez (MTF50)</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/optics.py"/>
        <source>spatial frequency at which lens and pixels together leave half of the contrast (MTF50); square pixels alone do at 0.603; left out, the lens is perfectly sharp</source>
        <translation>frecuencia espacial a la que objetivo y píxeles juntos dejan la mitad del contraste (MTF50); los píxeles cuadrados solos lo hacen a 0.603; si se omite, el objetivo es perfectamente nítido</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/optics.py"/>
        <source>vignetting</source>
        <translation>viñeteo</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/optics.py"/>
        <source>vignetting {0!r}: must be none, cos4, or one to three coefficients of r², r⁴ and r⁶</source>
        <translation>viñeteo {0!r}: debe ser none, cos4 o de uno a tres coeficientes de r², r⁴ y r⁶</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/optics.py"/>
        <source>vignetting {0!r}: must leave at most {1:g} times the light of the middle, not {2:.3g} at r = {3:.2g}</source>
        <translation>viñeteado {0!r}: debe dejar como mucho {1:g} veces la luz del centro, no {2:.3g} en r = {3:.2g}</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/optics.py"/>
        <source>vignetting {0!r}: must leave light up to the corner; {1:.3g} of it is left at r = {2:.3g}</source>
        <translation>viñeteo {0!r}: debe dejar luz hasta la esquina; en r = {2:.3g} queda {1:.3g}</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>Automatic</source>
        <translation>Automático</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>Bicubic</source>
        <translation>Bicúbico</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>Bilinear</source>
        <translation>Bilineal</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>Camera frame (as seen)</source>
        <translation>Encuadre de cámara (como se ve)</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>Classes of labels and buildings</source>
        <translation>Clases de etiquetas y edificios</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>Depth along the optical axis</source>
        <translation>Profundidad a lo largo del eje óptico</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>Faces that no map shows</source>
        <translation>Caras que ningún mapa muestra</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>GeoTIFF (lossless)</source>
        <translation>GeoTIFF (sin pérdida)</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>Ground points</source>
        <translation>Puntos del terreno</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>Instances of labels and buildings</source>
        <translation>Instancias de etiquetas y edificios</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>JPEG (smaller)</source>
        <translation>JPEG (menor)</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>Lanczos</source>
        <translation>Lanczos</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>Map frame (not resampled)</source>
        <translation>Encuadre de mapa (sin remuestreo)</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>Nearest pixel</source>
        <translation>Píxel más próximo</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>Normals of the ground</source>
        <translation>Normales del terreno</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>One ray per pixel</source>
        <translation>Un rayo por píxel</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>PNG</source>
        <translation>PNG</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>Raw values of the image sensor</source>
        <translation>Valores brutos del sensor de imagen</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>Roadmap</source>
        <translation>Callejero</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>Satellite</source>
        <translation>Satélite</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>Terrain</source>
        <translation>Relieve</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>allow exceeding the error budget</source>
        <translation>permitir superar el error admisible</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>allow upsampling</source>
        <translation>permitir sobremuestreo</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>also use zooms above the source's native one: images get more pixels, but no more detail</source>
        <translation>usar también zooms superiores al nativo de la fuente: las imágenes tienen más píxeles, pero no más detalle</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>band {0!r}: must be a name or a number</source>
        <translation>banda {0!r}: debe ser un nombre o un número</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>bands of a raster file, by name or by number from 1, in the order to write them in: 4 1 2 is infrared, red and green of a file with red, green, blue and infrared; left out, GeoTIFF has all of them, and JPEG and PNG the colours</source>
        <translation>bandas de un archivo ráster, por nombre o por número desde 1, en el orden en que se han de escribir: 4 1 2 son infrarrojo, rojo y verde de un archivo con rojo, verde, azul e infrarrojo; si se omite, GeoTIFF las tiene todas, y JPEG y PNG las de color</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>bands {0}: each may be named once</source>
        <translation>bandas {0}: cada una se puede nombrar una vez</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>coordinate reference system</source>
        <translation>sistema de referencia de coordenadas</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>coordinate reference system {0!r}: must be a code such as EPSG:2056</source>
        <translation>sistema de referencia de coordenadas {0!r}: debe ser un código como EPSG:2056</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>date of the imagery in the source's own format, where it offers several</source>
        <translation>fecha de las imágenes en el formato de la fuente, si ofrece varias</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>date {0!r}: must be text without spaces around it, such as 2024-06-21</source>
        <translation>fecha {0!r}: debe ser texto sin espacios alrededor, como 2024-06-21</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>error budget</source>
        <translation>error admisible</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>files with a value for every pixel, written beside the images: depth along the optical axis, ground points, normals, the mask of faces that no map shows, and the class and instance of labels and buildings; of all map types together; raw holds the values of an image sensor before demosaicing and development</source>
        <translation>archivos con un valor para cada píxel, escritos junto a las imágenes: profundidad a lo largo del eje óptico, puntos del terreno, normales, la máscara de caras que ningún mapa muestra, y la clase e instancia de etiquetas y edificios; comunes a todos los tipos de mapa; raw contiene los valores de un sensor de imagen antes de la interpolación cromática y del revelado</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>format of the image files, all of which are georeferenced; tif and png are lossless</source>
        <translation>formato de los archivos de imagen, todos georreferenciados; tif y png no tienen pérdida</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>frame</source>
        <translation>encuadre</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>ground sample distance (GSD) wanted of the source; the closest zoom is used</source>
        <translation>distancia de muestreo del terreno (GSD) que se pide a la fuente; se usa el zoom más próximo</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>ground under a camera frame: auto is a mesh as coarse as the error budget allows, rays traces one ray per pixel</source>
        <translation>terreno bajo un encuadre de cámara: auto es una malla tan gruesa como permite el error admisible; rays traza un rayo por píxel</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>how camera frames interpolate between the source's pixels; map frames are not resampled</source>
        <translation>cómo interpolan los encuadres de cámara entre los píxeles de la fuente; los encuadres de mapa no se remuestrean</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>how the values of a raster file become 8 bits: none leaves them as they are, so that JPEG and PNG need values of 8 bits; percentile stretches from the 2nd to the 98th percentile of the file; two numbers stretch from the first to the second</source>
        <translation>cómo pasan a 8 bits los valores de un archivo ráster: none los deja como están, de modo que JPEG y PNG necesitan valores de 8 bits; percentile realza del percentil 2 al 98 del archivo; dos números realzan del primero al segundo</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>image format</source>
        <translation>formato de imagen</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>image size</source>
        <translation>tamaño de imagen</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>image size {0} x {1} px: must be at most {2:,} px along a side and {3:,} px in all</source>
        <translation>tamaño de imagen {0} x {1} px: debe ser como máximo {2:,} px por lado y {3:,} px en total</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>image size {0} {1} {2}: needs a width and a height of 1 px or more, and 1 or 3 channels</source>
        <translation>tamaño de imagen {0} {1} {2}: necesita una anchura y una altura de 1 px o más, y 1 o 3 canales</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>image size {0}: must be three whole numbers, width, height and channels</source>
        <translation>tamaño de imagen {0}: deben ser tres números enteros, anchura, altura y canales</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>image's lo&amp;nger side</source>
        <translation>&amp;lado mayor de la imagen</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>image's longer side</source>
        <translation>lado mayor de la imagen</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>imageries</source>
        <translation>varias imágenes</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>imagery date</source>
        <translation>fecha de las imágenes</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>imagery {0!r}: must be text, such as 2014=world</source>
        <translation>imágenes {0!r}: debe ser texto, por ejemplo 2014=world</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>imagery {0}, and source {1} {2} {3} as well: must be one of the two</source>
        <translation>imágenes {0}, y además la fuente {1} {2} {3}: cada una nombra la suya, así que dé una de las dos</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>kinds of imagery, captured into one folder each</source>
        <translation>clases de imágenes, cada una capturada en su propia carpeta</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>limit of every image's longer side, in pixels of 256 px tiles: where an image would exceed it, all take a lower zoom; without it there is no limit, or 640 in the layout paper</source>
        <translation>límite del lado mayor de cada imagen, en píxeles de teselas de 256 px: si una imagen lo superara, todas toman un zoom menor; sin él no hay límite, o es 640 en la disposición paper</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>map types</source>
        <translation>tipos de mapa</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>map types {0}: each may be named once</source>
        <translation>tipos de mapa {0}: cada uno se puede nombrar una vez</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>map: a window of the source's own pixels, turned by multiples of 90° only, for cameras that look straight down; camera: the image as the camera sees it; auto: a map frame where its error fits the budget</source>
        <translation>map: una ventana de los píxeles propios de la fuente, girada solo en múltiplos de 90°, para cámaras que miran en vertical; camera: la imagen tal como la ve la cámara; auto: un encuadre de mapa donde su error cabe en el presupuesto</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>maximum image side</source>
        <translation>lado máximo de la imagen</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>maximum number of images</source>
        <translation>número máximo de imágenes</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>maximum sum of the error bounds of all stages, in pixels of the planned image; the cheapest methods within it are used</source>
        <translation>suma máxima de las cotas de error de todas las etapas, en píxeles de la imagen planificada; se usan los métodos más económicos que caben en ella</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>mesh</source>
        <translation>malla</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>missions with more images are refused</source>
        <translation>las misiones con más imágenes se rechazan</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>no map type: give one or more of {0}</source>
        <translation>ningún tipo de mapa: dé uno o más de {0}</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>pixels along the longer side of the camera's image; the zoom closest to its GSD is used; a named camera sets it</source>
        <translation>píxeles en el lado mayor de la imagen de la cámara; se usa el zoom más próximo a su GSD; una cámara con nombre tiene los suyos</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>products</source>
        <translation>productos</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>products {0}: each may be named once</source>
        <translation>productos {0}: cada uno puede nombrarse una vez</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>resize images: width, height, channels (1 or 3)</source>
        <translation>redimensionar las imágenes: anchura, altura, canales (1 o 3)</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>seed</source>
        <translation>semilla</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>seed of everything random, such as the synthetic landscape and gusts of wind</source>
        <translation>inicio de todo lo que es aleatorio, como el paisaje sintético y las ráfagas de viento</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>several imageries side by side, instead of a source, its date and map types: NAME=SOURCE, NAME=SOURCE@DATE or NAME=SOURCE:MAP_TYPE, each captured over the same ground into a folder NAME; without NAME=, the name is made from the source</source>
        <translation>varias imágenes de origen en paralelo, en lugar de una fuente, su fecha y sus tipos de mapa: NOMBRE=FUENTE, NOMBRE=FUENTE@FECHA o NOMBRE=FUENTE:TIPO, cada una capturada sobre el mismo terreno en una carpeta NOMBRE propia; sin NOMBRE=, con un nombre formado a partir de la fuente</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>source</source>
        <translation>fuente</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>source is empty: name one, or give a URL template or a file</source>
        <translation>la fuente está vacía: nombre una, o dé una plantilla de URL o un archivo</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>stretch</source>
        <translation>realce</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>stretch {0!r}: must be none, percentile, or two numbers, the lower one first</source>
        <translation>realce {0!r}: debe ser none, percentile o dos números, primero el menor</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>system of the images, such as EPSG:2056: one in which the source has pixels, or EPSG:3857 for those of the Web-Mercator map; left out, the source's own, or the map's where a service has both</source>
        <translation>sistema de las imágenes, como EPSG:2056: uno en el que la fuente tenga píxeles, o EPSG:3857 para los del mapa Web Mercator; si se omite, el de la fuente, o el del mapa si un servicio tiene ambos</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>use the most accurate methods where none stay within the error budget, instead of refusing the mission</source>
        <translation>usar los métodos más exactos si ninguno cabe en el error admisible, en lugar de rechazar la misión</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>where the imagery comes from: a name or title (see terrainav sources), a URL template, wmts:URL#layer=NAME, wms:URL#layers=NAME, arcgis:URL, ogcapi:URL, or a file (GeoTIFF, VRT, MBTiles, …)</source>
        <translation>de dónde vienen las imágenes: un nombre o título (véase terrainav sources), una plantilla de URL, wmts:URL#layer=NOMBRE, wms:URL#layers=NOMBRE, arcgis:URL, ogcapi:URL o un archivo (GeoTIFF, VRT, MBTiles, …)</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>zoom</source>
        <translation>zoom</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>zoom of the source, instead of the one closest to the camera's GSD</source>
        <translation>zoom de la fuente, en lugar del más próximo a la GSD de la cámara</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/pictures.py"/>
        <source>zoom {0} and ground sample distance {1} m: give one of the two</source>
        <translation>zoom {0} y distancia de muestreo del terreno de {1} m: dé uno de los dos</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>Bayer pattern of the sensor, from its upper left pixel, row by row; without one, each pixel measures every colour</source>
        <translation>patrón de Bayer del sensor, desde su píxel superior izquierdo, fila por fila; sin él, cada píxel mide todos los colores</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>Blue green, green red</source>
        <translation>Azul verde, verde rojo</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>Gradient-corrected</source>
        <translation>Corregida por gradientes</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>Green blue, red green</source>
        <translation>Verde azul, rojo verde</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>Green red, blue green</source>
        <translation>Verde rojo, azul verde</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>None</source>
        <translation>Ninguno</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>Red green, green blue</source>
        <translation>Rojo verde, verde azul</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>bits of a raw value; the named sensor's, unless given, whose gain and black level follow</source>
        <translation>bits de un valor bruto; los del sensor nombrado, si no se indican, cuya ganancia y nivel de negro se ajustan</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>bits of the converter</source>
        <translation>bits del convertidor</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>black level</source>
        <translation>nivel de negro</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>black level {0:g} DN: must be below {1}, the largest number of {2} bits</source>
        <translation>nivel de negro {0:g} DN: debe ser menor que {1}, el mayor número de {2} bits</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>colour filters</source>
        <translation>filtros de color</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>dark current</source>
        <translation>corriente de oscuridad</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>dark signal non-uniformity</source>
        <translation>falta de uniformidad de la señal de oscuridad</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>demosaicing</source>
        <translation>interpolación cromática</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>digital number of a pixel without electrons; the named sensor's, unless given</source>
        <translation>número digital de un píxel sin electrones; el del sensor nombrado, si no se indica</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>digital numbers per electron (K); the named sensor's, unless given, and where its data sheet has none the one with which the full well reaches the largest number</source>
        <translation>números digitales por electrón (K); la del sensor nombrado, si no se indica, y si su hoja de datos no la tiene, aquella con la que el pozo lleno alcanza el mayor número</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>distance between the centres of the sensor's pixels; the named sensor's, unless given</source>
        <translation>distancia entre los centros de los píxeles del sensor; la del sensor nombrado, si no se indica</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>electrons per photon; the named sensor's, unless given</source>
        <translation>electrones por fotón; la del sensor nombrado, si no se indica</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>electrons per pixel and second without light; the named sensor's, unless given</source>
        <translation>electrones por píxel y segundo sin luz; la del sensor nombrado, si no se indica</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>electrons that a pixel holds, its saturation capacity; the named sensor's, unless given</source>
        <translation>electrones que caben en un píxel, su capacidad de saturación; la del sensor nombrado, si no se indica</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>full well</source>
        <translation>pozo lleno</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>how the colours that a pixel does not measure are found: bilinear from the nearest, malvar corrected by gradients (Malvar, He and Cutler 2004)</source>
        <translation>cómo se hallan los colores que un píxel no mide: bilinear de los más cercanos, malvar corregida por gradientes (Malvar, He y Cutler 2004)</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>image sensor</source>
        <translation>sensor de imagen</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>image sensor {0!r}: must be a name without spaces around it</source>
        <translation>sensor de imagen {0!r}: debe ser un nombre sin espacios alrededor</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>image sensor {0}: needs its {1}</source>
        <translation>sensor de imagen {0}: necesita el dato «{1}»</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>name one, or {0}{1}</source>
        <translation>nombre uno, o {0}{1}</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>photo response non-uniformity</source>
        <translation>falta de uniformidad de la respuesta a la luz</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>pixel pitch</source>
        <translation>paso de píxel</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>quantum efficiency</source>
        <translation>eficiencia cuántica</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>read noise</source>
        <translation>ruido de lectura</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>sensor whose noise, saturation and quantisation images have, after EMVA 1288: a name, as terrainav cameras sensors lists them, or custom for figures of your own; left out, the sensor is ideal</source>
        <translation>sensor cuyo ruido, saturación y cuantización tienen las imágenes, según EMVA 1288: un nombre de los que enumera terrainav cameras sensors, o custom para cifras propias; si se omite, el sensor es ideal</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>standard deviation of the pixels' fixed offsets (DSNU); the named sensor's, unless given</source>
        <translation>desviación típica de los desplazamientos fijos de los píxeles (DSNU); la del sensor nombrado, si no se indica</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>standard deviation of the pixels' fixed sensitivities (PRNU); the named sensor's, unless given</source>
        <translation>desviación típica de las sensibilidades fijas de los píxeles (PRNU); la del sensor nombrado, si no se indica</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>standard deviation of the temporal noise in the dark; the named sensor's, unless given</source>
        <translation>desviación típica del ruido temporal en la oscuridad; la del sensor nombrado, si no se indica</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>system gain</source>
        <translation>ganancia del sistema</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sensor.py"/>
        <source>{0} {1}: needs an image sensor</source>
        <translation>{0} {1}: necesita un sensor de imagen</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/shutter.py"/>
        <source>blur by motion</source>
        <translation>desenfoque por movimiento</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/shutter.py"/>
        <source>blur images by the motion of the camera during the exposure time</source>
        <translation>desenfoca las imágenes según el movimiento de la cámara durante el tiempo de exposición</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/shutter.py"/>
        <source>row time</source>
        <translation>tiempo por fila</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/shutter.py"/>
        <source>time from the exposure of a row of pixels to that of the next one (rolling shutter), from the top of the image to its bottom; 0 for a global shutter</source>
        <translation>tiempo desde la exposición de una fila de píxeles hasta la de la siguiente (obturador rodante), de la parte superior de la imagen a la inferior; 0 para un obturador global</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sunlight.py"/>
        <source>sun over the synthetic world, whose relief, houses and trees it lights and whose shadows it casts: off; time, for where it stands at the start of the flight; or its height and azimuth in degrees, such as 30 135. Photographs have the light in which they were taken</source>
        <translation>sol sobre el mundo sintético, que ilumina su relieve, sus casas y sus árboles y proyecta sus sombras: off, sin sol; time, donde está al inicio del vuelo; o su altura y su acimut en grados, como 30 135. Las fotografías tienen la luz con la que se tomaron</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/sunlight.py"/>
        <source>sun {0!r}: must be {1}, {2}, or its height and azimuth in degrees, such as 30 135</source>
        <translation>sol {0!r}: debe ser {1}, {2}, o su altura y su acimut en grados, como 30 135</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>As the source says</source>
        <translation>Lo que diga la fuente</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>Feet</source>
        <translation>Pies</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>Filled from the next source</source>
        <translation>Se rellenan con la fuente siguiente</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>Interpolated where no source has any</source>
        <translation>Se interpolan donde ninguna fuente las tiene</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>Metres</source>
        <translation>Metros</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>Refused</source>
        <translation>Se rechazan</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>The ellipsoid</source>
        <translation>El elipsoide</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>The ground below</source>
        <translation>El terreno debajo</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>The take-off</source>
        <translation>El despegue</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>US survey feet</source>
        <translation>Pies de agrimensura de EE. UU.</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>added to the heights of all sources, for example for a datum whose grid is missing</source>
        <translation>se suma a las alturas de todas las fuentes, p. ej. para un dátum del que no hay rejilla aquí</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>buildings</source>
        <translation>edificios</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>buildings that stand on the relief with walls and roofs: vector files of footprints (GeoJSON, GeoPackage, OSM …), as FILE or FILE:LAYER, or CityJSON files; over level ground, give its height as the elevation</source>
        <translation>edificios que se alzan sobre el relieve con muros y tejados: archivos vectoriales de plantas (GeoJSON, GeoPackage, OSM …), como ARCHIVO o ARCHIVO:CAPA, o archivos CityJSON; sobre terreno llano, indique su altura como elevación</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>buildings {0!r}: must be a file, or FILE:LAYER</source>
        <translation>edificios {0!r}: debe ser un archivo, o ARCHIVO:CAPA</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>buildings {0}: each file may be named once</source>
        <translation>edificios {0}: cada archivo puede indicarse una vez</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>buildings {0}: need an elevation, the ground that they stand on</source>
        <translation>edificios {0}: necesitan una elevación, el terreno sobre el que se alzan</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>clearance</source>
        <translation>distancia de seguridad</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>clearance distance</source>
        <translation>alcance de la distancia de seguridad</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>climb rate</source>
        <translation>velocidad de ascenso</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>default height</source>
        <translation>altura por omisión</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>elevation</source>
        <translation>elevación</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>field with the heights of buildings, in metres or with a unit; by default height, building:height, measuredHeight or the like, otherwise levels of 3 m</source>
        <translation>campo con las alturas de los edificios, en metros o con unidad; por omisión height, building:height, measuredHeight o similar, si no, plantas de 3 m</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>height above</source>
        <translation>altura sobre</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>height field</source>
        <translation>campo de altura</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>height field {0!r}: must be the name of a field, without spaces around it</source>
        <translation>campo de altura {0!r}: debe ser el nombre de un campo, sin espacios alrededor</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>height of buildings for which the file has no height and no levels</source>
        <translation>altura de los edificios para los que el archivo no tiene altura ni plantas</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>height offset</source>
        <translation>desplazamiento de altura</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>height tolerance</source>
        <translation>tolerancia de altura</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>height unit</source>
        <translation>unidad de altura</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>heights of what cameras see, with buildings and trees, if that differs from the elevation, which the flight follows; given like the elevation, which fills its gaps</source>
        <translation>de dónde vienen las alturas de lo que ven las cámaras, con edificios y árboles, si no es lo que sigue el vuelo; se nombra como la elevación, que completa sus huecos</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>heights {0!r}: must be a file, terrarium, world or a number</source>
        <translation>alturas {0!r}: debe ser un archivo, terrarium, world o un número</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>missing heights</source>
        <translation>alturas que faltan</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>name a source of heights, or give the height of level ground in metres{0}</source>
        <translation>indique una fuente de alturas, o la altura del terreno llano en metros{0}</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>name it as the elevation{0}</source>
        <translation>indíquela como elevación{0}</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>over relief, maximum rate of climb and descent: the flight is higher where the ground is steeper</source>
        <translation>sobre relieve, velocidad máxima de ascenso y descenso: el vuelo va más alto donde el terreno es más empinado</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>over relief, minimum height above everything within the clearance distance</source>
        <translation>sobre relieve, altura mínima sobre todo lo que haya dentro del alcance de la distancia de seguridad</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>over relief, reference of the heights of captures: the ground below each one; the ground at the take-off (an area's north-western corner, or the first point), for one height of all; or the ellipsoid</source>
        <translation>sobre relieve, respecto a qué son las alturas de las capturas: el terreno debajo de cada una; el terreno en el despegue (la esquina noroeste de un área, o el primer punto), una altura para todas; o el elipsoide</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>over relief, with the trigger by distance, how far flights in files for drones may be above or below the planned ones, so that rows need fewer waypoints; 0 keeps them no lower than planned, and hardly higher</source>
        <translation>sobre relieve, con el disparo por distancia, cuánto pueden estar los vuelos de los archivos para drones por encima o por debajo de los planificados, para que las pasadas necesiten menos puntos de paso; 0 los mantiene no más bajos que lo planificado y apenas más altos</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>radius around each capture within which the clearance is kept</source>
        <translation>radio en torno a cada captura en el que se mantiene la distancia de seguridad</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>reference of the heights: ellipsoid, EGM96, EGM2008, or the code of a vertical system such as EPSG:5773; by default the one that the source states, otherwise the ellipsoid</source>
        <translation>desde dónde cuentan las alturas: ellipsoid, EGM96, EGM2008 o el código de un sistema vertical como EPSG:5773; si se omite, lo que indique la fuente, y el elipsoide donde no indique nada</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>surface</source>
        <translation>superficie</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>surface {0}: needs an elevation as well, the ground that the flight follows</source>
        <translation>superficie {0}: necesita también una elevación, el terreno que sigue el vuelo</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>treatment of places in the area where the first source of heights has none: filled from the next source that has one, and counted; or also interpolated where no source has one, from heights within 100 pixels on all sides; or refused</source>
        <translation>qué se hace con los lugares del área de los que la primera fuente no tiene altura: se rellenan con la siguiente fuente que la tenga, y se cuentan; o además se interpolan donde ninguna la tiene, a partir de alturas a menos de 100 píxeles por todos los lados; o se rechazan</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>unit of the sources of heights; by default the one that they state, otherwise metres</source>
        <translation>unidad de las fuentes de alturas; si se omite, la que ellas indiquen, y metros donde no indiquen ninguna</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>vertical datum</source>
        <translation>dátum vertical</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/terrain.py"/>
        <source>where heights of the ground come from: raster files, terrarium (public tiles), terrarium:SOURCE or terrain-rgb:SOURCE (tiles so encoded), world, or a number; of several the first that has a height counts; left out, the ground is level</source>
        <translation>de dónde vienen las alturas del terreno: archivos ráster, terrarium (teselas públicas), terrarium:FUENTE o terrain-rgb:FUENTE (teselas así codificadas), world o un número; de varias cuenta la primera que tenga una altura; si falta, el terreno es llano</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/varied.py"/>
        <source>add bounds as {0}</source>
        <translation>añada límites como {0}</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/varied.py"/>
        <source>also write each image without noise, blur and other effects on light, under the same name into the folder of its map type with _clean appended</source>
        <translation>escribir también cada imagen sin ruido, desenfoque ni otros efectos sobre la luz, con el mismo nombre, en la carpeta de su tipo de mapa con _clean añadido</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/varied.py"/>
        <source>also write each image without the lens's distortion, drawn from the imagery with the same focal length, under the same name into the folder of its map type with _undistorted appended</source>
        <translation>escribir también cada imagen sin la distorsión del objetivo, dibujada a partir de las imágenes con la misma distancia focal, con el mismo nombre, en la carpeta de su tipo de mapa con _undistorted añadido</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/varied.py"/>
        <location filename="../../core/mission/sensors.py"/>
        <source>did you mean {0}?</source>
        <translation>¿quería decir {0}?</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/varied.py"/>
        <source>distance from the planned pose</source>
        <translation>distancia a la pose planificada</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/varied.py"/>
        <source>fields of camera, light and pose that have a random value in each image, by the seed, as FIELD=DISTRIBUTION: uniform(low,high), normal(mean,sd), lognormal(median,sigma), loguniform(low,high), triangular(low,mode,high) or choice(value,…), and within(low,high) after it as bounds</source>
        <translation>campos de cámara, luz y pose que tienen un valor aleatorio en cada imagen, según la semilla, como CAMPO=DISTRIBUCIÓN: uniform(low,high), normal(mean,sd), lognormal(median,sigma), loguniform(low,high), triangular(low,mode,high) o choice(valor,…), y detrás within(low,high) como límites</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/varied.py"/>
        <source>fields that may are {0}</source>
        <translation>los campos que pueden son {0}</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/varied.py"/>
        <source>keep clean images</source>
        <translation>conservar imágenes limpias</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/varied.py"/>
        <source>keep undistorted images</source>
        <translation>conservar imágenes sin distorsión</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/varied.py"/>
        <source>offset to the east</source>
        <translation>desplazamiento hacia el este</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/varied.py"/>
        <source>offset to the north</source>
        <translation>desplazamiento hacia el norte</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/varied.py"/>
        <source>plan a mission for each</source>
        <translation>planifique una misión para cada una</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/varied.py"/>
        <source>random values</source>
        <translation>valores aleatorios</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/varied.py"/>
        <source>vary {0!r}: has no bounds, and {1} must be {2}</source>
        <translation>vary {0!r}: no tiene límites, y {1} debe ser {2}</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/varied.py"/>
        <source>vary {0!r}: must be text</source>
        <translation>vary {0!r}: debe ser texto</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/varied.py"/>
        <source>vary {0!r}: the images of a mission have one shape</source>
        <translation>vary {0!r}: las imágenes de una misión tienen una sola forma</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/varied.py"/>
        <source>vary {0!r}: {1} appears twice</source>
        <translation>vary {0!r}: {1} aparece dos veces</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/varied.py"/>
        <source>vary {0!r}: {1} may not vary: {2}</source>
        <translation>vary {0!r}: {1} no puede variar: {2}</translation>
    </message>
    <message>
        <location filename="../../core/mission/parts/varied.py"/>
        <source>vary {0}: with {1}, {2}</source>
        <translation>vary {0}: con {1}, {2}</translation>
    </message>
    <message>
        <location filename="../../core/mission/plan.py"/>
        <source>choose one of them as the source</source>
        <translation>elija una de ellas como fuente</translation>
    </message>
    <message>
        <location filename="../../core/mission/plan.py"/>
        <source>exposure and reading of rows take {0:.4g} ms: longer than the {1:.4g} ms between two images</source>
        <translation>la exposición y la lectura de las filas duran {0:.4g} ms: más que los {1:.4g} ms entre dos imágenes</translation>
    </message>
    <message>
        <location filename="../../core/mission/plan.py"/>
        <source>exposure time {0:g} ms: longer than the {1:.4g} ms between two images</source>
        <translation>tiempo de exposición {0:g} ms: más largo que los {1:.4g} ms entre dos imágenes</translation>
    </message>
    <message>
        <location filename="../../core/mission/plan.py"/>
        <source>fly higher or in less turbulence</source>
        <translation>vuele más alto o con menos turbulencia</translation>
    </message>
    <message>
        <location filename="../../core/mission/plan.py"/>
        <source>fly slower, overlap less or shorten the exposure</source>
        <translation>vuele más despacio, solape menos o acorte la exposición</translation>
    </message>
    <message>
        <location filename="../../core/mission/plan.py"/>
        <source>fly slower, overlap less or shorten the row time</source>
        <translation>vuele más despacio, use menos solape o acorte el tiempo por fila</translation>
    </message>
    <message>
        <location filename="../../core/mission/plan.py"/>
        <source>imagery {0}: a mission of several imageries needs a plan for each of them</source>
        <translation>imágenes {0}: una misión de varias imágenes tiene un plan para cada una, y no uno solo</translation>
    </message>
    <message>
        <location filename="../../core/mission/plan.py"/>
        <source>no-fly areas</source>
        <translation>zonas de exclusión</translation>
    </message>
    <message>
        <location filename="../../core/mission/plan.py"/>
        <source>random yaw with a tilt of {0:g} and a roll of {1:g} deg: must look straight down</source>
        <translation>guiñada al azar con una inclinación de {0:g} y un alabeo de {1:g} grados: debe mirar recto hacia abajo</translation>
    </message>
    <message>
        <location filename="../../core/mission/plan.py"/>
        <source>wind of {0:g} m/s at {1:g} m: the gusts throw the camera to the ground</source>
        <translation>viento de {0:g} m/s a {1:g} m: las ráfagas tiran la cámara al suelo</translation>
    </message>
    <message>
        <location filename="../../core/mission/pose_table.py"/>
        <source>name it tilt (0 looks straight down) or gimbal_pitch (-90 does)</source>
        <translation>llámela tilt (0 mira en vertical hacia abajo) o gimbal_pitch (-90 lo hace)</translation>
    </message>
    <message>
        <location filename="../../core/mission/pose_table.py"/>
        <source>{0} has a quotation mark without another one that ends the cell</source>
        <translation>{0} tiene una comilla sin otra que cierre la celda</translation>
    </message>
    <message>
        <location filename="../../core/mission/pose_table.py"/>
        <source>{0} {1!r} has {2} cells; its header names {3}</source>
        <translation>{0} {1!r} tiene {2} celdas; su cabecera nombra {3}</translation>
    </message>
    <message>
        <location filename="../../core/mission/pose_table.py"/>
        <source>{0} {1} {2!r}: must be a number</source>
        <translation>{0} {1} {2!r}: debe ser un número</translation>
    </message>
    <message>
        <location filename="../../core/mission/pose_table.py"/>
        <source>{0}: columns {1} say the same</source>
        <translation>{0}: las columnas {1} dicen lo mismo</translation>
    </message>
    <message>
        <location filename="../../core/mission/pose_table.py"/>
        <source>{0}: has no column {1}, only {2}</source>
        <translation>{0}: no tiene la columna {1}, solo {2}</translation>
    </message>
    <message>
        <location filename="../../core/mission/pose_table.py"/>
        <source>{0}: its column pitch may count from the horizon or from straight down</source>
        <translation>{0}: su columna pitch puede contarse desde el horizonte o desde la vertical hacia abajo</translation>
    </message>
    <message>
        <location filename="../../core/mission/presets.py"/>
        <source>Consumer drone</source>
        <translation>Dron de consumo</translation>
    </message>
    <message>
        <location filename="../../core/mission/presets.py"/>
        <source>For machine learning</source>
        <translation>Para aprendizaje automático</translation>
    </message>
    <message>
        <location filename="../../core/mission/presets.py"/>
        <source>For mapping</source>
        <translation>Para cartografía</translation>
    </message>
    <message>
        <location filename="../../core/mission/presets.py"/>
        <source>For navigation</source>
        <translation>Para navegación</translation>
    </message>
    <message>
        <location filename="../../core/mission/presets.py"/>
        <source>Global shutter open for 0.5 ms, automatic ISO, sensor with the noise of its EMVA 1288 data sheet</source>
        <translation>Obturador global abierto durante 0,5 ms, ISO automático, sensor con el ruido de su hoja de datos EMVA 1288</translation>
    </message>
    <message>
        <location filename="../../core/mission/presets.py"/>
        <source>Ideal</source>
        <translation>Ideal</translation>
    </message>
    <message>
        <location filename="../../core/mission/presets.py"/>
        <source>Machine-vision camera</source>
        <translation>Cámara de visión artificial</translation>
    </message>
    <message>
        <location filename="../../core/mission/presets.py"/>
        <source>No effects: a pinhole camera without noise</source>
        <translation>Sin efectos: una cámara estenopeica sin ruido</translation>
    </message>
    <message>
        <location filename="../../core/mission/presets.py"/>
        <source>No overlap, square images of {0} × {0} px, lossless PNG; satellite and roadmap where the source has both</source>
        <translation>Sin solape, imágenes cuadradas de {0} × {0} px, PNG sin pérdida; satélite y callejero si la fuente tiene ambos</translation>
    </message>
    <message>
        <location filename="../../core/mission/presets.py"/>
        <source>Overlap {0:g} %, true perspective as the camera sees it, lossless GeoTIFF with the pose</source>
        <translation>Solape {0:g} %, perspectiva real como la ve la cámara, GeoTIFF sin pérdida con la pose</translation>
    </message>
    <message>
        <location filename="../../core/mission/presets.py"/>
        <source>Overlap {0:g}/{1:g} %, camera along the track, JPEG with the pose in EXIF and XMP, which drone photogrammetry software reads</source>
        <translation>Solape {0:g}/{1:g} %, cámara en el sentido del vuelo, JPEG con la pose en EXIF y XMP, que leen los programas de fotogrametría con drones</translation>
    </message>
    <message>
        <location filename="../../core/mission/presets.py"/>
        <source>Rolling shutter, small pixels below colour filters, automatic ISO, soft tone curve, and a visibility of 20 km</source>
        <translation>Obturador rodante, píxeles pequeños bajo filtros de color, ISO automático, curva tonal suave y visibilidad de 20 km</translation>
    </message>
    <message>
        <location filename="../../core/mission/presets.py"/>
        <source>preset {0!r}: must be one of {1}</source>
        <translation>ajuste {0!r}: debe ser uno de {1}</translation>
    </message>
    <message>
        <location filename="../../core/mission/relief/ground.py"/>
        <source>name a further source that fills it{0}, or have holes interpolated{1}</source>
        <translation>nombre otra fuente que lo complete{0}, o haga interpolar los huecos{1}</translation>
    </message>
    <message>
        <location filename="../../core/mission/relief/ground.py"/>
        <source>no height at latitude {0:.6f}, longitude {1:.6f}: the elevation ends there, or has a hole</source>
        <translation>sin altura en la latitud {0:.6f}, longitud {1:.6f}: la elevación termina allí, o tiene un hueco</translation>
    </message>
    <message>
        <location filename="../../core/mission/relief/ground.py"/>
        <source>rays over relief: the ground is level</source>
        <translation>rayos sobre relieve: el terreno es llano</translation>
    </message>
    <message>
        <location filename="../../core/mission/relief/modelled.py"/>
        <source>capture at latitude {0:.6f}, longitude {1:.6f}, {2:.1f} m above the ellipsoid: the surface there rises to {3:.1f} m, and {4:g} m of clearance are to be kept</source>
        <translation>captura en la latitud {0:.6f}, longitud {1:.6f}, a {2:.1f} m sobre el elipsoide: la superficie sube allí hasta {3:.1f} m, y hay que mantener {4:g} m de distancia de seguridad</translation>
    </message>
    <message>
        <location filename="../../core/mission/relief/modelled.py"/>
        <source>capture at latitude {0:.6f}, longitude {1:.6f}, {2:.1f} m above the ellipsoid: what its image may see there rises to {3:.1f} m</source>
        <translation>captura en la latitud {0:.6f}, longitud {1:.6f}, a {2:.1f} m sobre el elipsoide: lo que su imagen puede ver allí sube hasta {3:.1f} m</translation>
    </message>
    <message>
        <location filename="../../core/mission/relief/modelled.py"/>
        <source>clearance {0:g} m and height {1:g} m above ground: the clearance must be the smaller one</source>
        <translation>distancia de seguridad {0:g} m y altura {1:g} m sobre el terreno: la distancia de seguridad debe ser la menor</translation>
    </message>
    <message>
        <location filename="../../core/mission/relief/modelled.py"/>
        <source>elevation {0}: the mission is planned without its heights</source>
        <translation>elevación {0}: la misión se planifica sin sus alturas</translation>
    </message>
    <message>
        <location filename="../../core/mission/relief/modelled.py"/>
        <source>fly higher, or keep a clearance ({0})</source>
        <translation>vuele más alto, o mantenga una distancia de seguridad ({0})</translation>
    </message>
    <message>
        <location filename="../../core/mission/relief/modelled.py"/>
        <source>fly {0:.0f} m higher, or above the ground below</source>
        <translation>vuele {0:.0f} m más alto, o sobre el terreno debajo</translation>
    </message>
    <message>
        <location filename="../../core/mission/relief/modelled.py"/>
        <source>hole in the heights at latitude {0:.6f}, longitude {1:.6f}: the first source has none there</source>
        <translation>hueco en las alturas en la latitud {0:.6f}, longitud {1:.6f}: la primera fuente no tiene ninguna ahí</translation>
    </message>
    <message>
        <location filename="../../core/mission/relief/modelled.py"/>
        <source>relief of {0} from {1:.1f} to {2:.1f} m above the ellipsoid</source>
        <translation>relieve de {0} de {1:.1f} a {2:.1f} m sobre el elipsoide</translation>
    </message>
    <message>
        <location filename="../../core/mission/relief/modelled.py"/>
        <source>take a further source that fills it ({0})</source>
        <translation>tome otra fuente que lo rellene ({0})</translation>
    </message>
    <message>
        <location filename="../../core/mission/sensors.py"/>
        <source>image sensor {0!r} is unknown: {1}</source>
        <translation>sensor de imagen {0!r} desconocido: {1}</translation>
    </message>
    <message>
        <location filename="../../core/mission/sensors.py"/>
        <source>known are {0} and {1}</source>
        <translation>se conocen {0} y {1}</translation>
    </message>
    <message>
        <location filename="../../core/mission/settings.py"/>
        <source>area {0!r} and coords {1!r}: give one of the two</source>
        <translation>área {0!r} y coords {1!r}: dé uno de los dos</translation>
    </message>
    <message>
        <location filename="../../core/mission/settings.py"/>
        <source>area {0!r}: needs a height, --agl</source>
        <translation>área {0!r}: necesita una altura, --agl</translation>
    </message>
    <message>
        <location filename="../../core/mission/settings.py"/>
        <source>aspect ratio {0:g} {1:g}: width and height must be above 0</source>
        <translation>relación de aspecto {0:g} {1:g}: anchura y altura deben ser mayores que 0</translation>
    </message>
    <message>
        <location filename="../../core/mission/settings.py"/>
        <source>config file {0}: cannot be read as JSON ({1})</source>
        <translation>archivo de configuración {0}: no se puede leer como JSON ({1})</translation>
    </message>
    <message>
        <location filename="../../core/mission/settings.py"/>
        <source>config file {0}: must hold a JSON object of options</source>
        <translation>archivo de configuración {0}: debe contener un objeto JSON de opciones</translation>
    </message>
    <message>
        <location filename="../../core/mission/settings.py"/>
        <source>config file {0}: unknown option {1!r}{2}</source>
        <translation>archivo de configuración {0}: opción desconocida {1!r}{2}</translation>
    </message>
    <message>
        <location filename="../../core/mission/settings.py"/>
        <source>no coordinates: give --coords, such as --coords "35.16_-89.90_35.115_-89.823_120"</source>
        <translation>sin coordenadas: dé --coords, como --coords "35.16_-89.90_35.115_-89.823_120"</translation>
    </message>
    <message>
        <location filename="../../core/mission/settings.py"/>
        <source>{0} and {1}: give one of the two</source>
        <translation>{0} y {1}: dé uno de los dos</translation>
    </message>
    <message>
        <location filename="../../core/mission/settings.py"/>
        <source>{0} {1}: needs {2} as well</source>
        <translation>{0} {1}: necesita también {2}</translation>
    </message>
    <message>
        <location filename="../../core/mission/sunlight.py"/>
        <source>start by day{0}, or give its height and azimuth</source>
        <translation>empiece de día{0}, o indique su altura y su acimut</translation>
    </message>
    <message>
        <location filename="../../core/mission/sunlight.py"/>
        <source>sun {0}: at {1} it is {2:.1f} degrees below the horizon</source>
        <translation>sol {0}: a las {1} está {2:.1f} grados bajo el horizonte</translation>
    </message>
    <message>
        <location filename="../../core/mission/sunlight.py"/>
        <source>sun {0}: needs the start of the flight</source>
        <translation>sol {0}: necesita el inicio del vuelo</translation>
    </message>
    <message>
        <location filename="../../core/mission/takes.py"/>
        <source>blur of up to {0:.2g} px in {1:g} ms, {2} instants each</source>
        <translation>desenfoque de hasta {0:.2g} px en {1:g} ms, {2} instantes por imagen</translation>
    </message>
    <message>
        <location filename="../../core/mission/takes.py"/>
        <source>none: the camera hovers</source>
        <translation>ninguno: la cámara permanece en el aire sin moverse</translation>
    </message>
    <message>
        <location filename="../../core/mission/takes.py"/>
        <source>none: the camera is at rest</source>
        <translation>ninguno: la cámara está en reposo</translation>
    </message>
    <message>
        <location filename="../../core/mission/takes.py"/>
        <source>skew of up to {0:.2g} px in {1:.3g} ms</source>
        <translation>inclinación de hasta {0:.2g} px en {1:.3g} ms</translation>
    </message>
    <message>
        <location filename="../../core/mission/views.py"/>
        <source>view of a map frame: its image is a window of the source as it is</source>
        <translation>vista de un encuadre de mapa: su imagen es una ventana de la fuente tal como es</translation>
    </message>
    <message>
        <location filename="../../core/mosaic/bigtiff.py"/>
        <location filename="../../terrainav_plugin/dataset/mosaic.py"/>
        <source>mosaic {0}: cannot be written ({1})</source>
        <translation>mosaico {0}: no se puede escribir ({1})</translation>
    </message>
    <message>
        <location filename="../../core/mosaic/frames.py"/>
        <source>folder {0}: has no image to make a mosaic of</source>
        <translation>carpeta {0}: no tiene ninguna imagen con la que hacer un mosaico</translation>
    </message>
    <message>
        <location filename="../../core/mosaic/frames.py"/>
        <source>image {0}: has no georeference</source>
        <translation>imagen {0}: no tiene georreferencia</translation>
    </message>
    <message>
        <location filename="../../core/mosaic/frames.py"/>
        <source>relief: the ground is level</source>
        <translation>relieve: el terreno es llano</translation>
    </message>
    <message>
        <location filename="../../core/mosaic/orthomosaic.py"/>
        <source>give a larger ground sample distance</source>
        <translation>indique una distancia de muestreo del terreno mayor</translation>
    </message>
    <message>
        <location filename="../../core/mosaic/orthomosaic.py"/>
        <source>ground sample distance {0} m: must be a number above 0</source>
        <translation>distancia de muestreo del terreno {0} m: debe ser un número mayor que 0</translation>
    </message>
    <message>
        <location filename="../../core/mosaic/orthomosaic.py"/>
        <source>image {0}: shows no ground that a map in {1} has</source>
        <translation>imagen {0}: no muestra terreno que tenga un mapa en {1}</translation>
    </message>
    <message>
        <location filename="../../core/mosaic/orthomosaic.py"/>
        <source>mosaic of {0:,.9g} x {1:,.9g} px: at most {2:,} px along a side</source>
        <translation>mosaico de {0:,.9g} x {1:,.9g} px: como mucho {2:,} px por lado</translation>
    </message>
    <message>
        <location filename="../../core/mosaic/orthomosaic.py"/>
        <source>mosaic {0}: must end in {1}</source>
        <translation>mosaico {0}: debe terminar en {1}</translation>
    </message>
    <message>
        <location filename="../../core/mosaic/orthomosaic.py"/>
        <location filename="../../terrainav_plugin/dataset/mosaic.py"/>
        <source>mosaic: stopped</source>
        <translation>mosaico: detenido</translation>
    </message>
    <message>
        <location filename="../../core/picture/camera_frame.py"/>
        <source>no imagery at {0} of the samples that the image is made of</source>
        <translation>no hay imágenes en {0} de las muestras de las que se hace la imagen</translation>
    </message>
    <message>
        <location filename="../../core/picture/cost.py"/>
        <source>footprints {0}, images {1} each, {2} of one core in all ({3})</source>
        <translation>huellas {0}, imágenes {1} cada una, {2} de un núcleo en total ({3})</translation>
    </message>
    <message>
        <location filename="../../core/picture/cost.py"/>
        <source>timed here</source>
        <translation>medido aquí</translation>
    </message>
    <message>
        <location filename="../../core/picture/cost.py"/>
        <source>timed here, over relief with {0}</source>
        <translation>medido aquí, sobre el relieve con {0}</translation>
    </message>
    <message>
        <location filename="../../core/picture/effects.py"/>
        <source>effects of a real camera: need grey, or red, green and blue of 8 bits, and the source gives {0}</source>
        <translation>efectos de una cámara real: necesitan gris, o rojo, verde y azul de 8 bits, y la fuente da {0}</translation>
    </message>
    <message>
        <location filename="../../core/picture/effects.py"/>
        <source>lens with a scale of red or blue: needs red, green and blue of 8 bits, and the source gives {0}</source>
        <translation>objetivo con escala del rojo o del azul: necesita rojo, verde y azul de 8 bits, y la fuente da {0}</translation>
    </message>
    <message>
        <location filename="../../core/picture/heights.py"/>
        <source>field {0!r} of heights: no file of buildings has it, but {1}</source>
        <translation>campo {0!r} de alturas: ningún archivo de edificios lo tiene, sino {1}</translation>
    </message>
    <message>
        <location filename="../../core/picture/heights.py"/>
        <location filename="../../core/vectors/layer.py"/>
        <source>no fields</source>
        <translation>ningún campo</translation>
    </message>
    <message>
        <location filename="../../core/picture/map_frame.py"/>
        <source>image size {0} {1} {2}: the source has {3}, which make no colours; 1 channel would be right</source>
        <translation>tamaño de imagen {0} {1} {2}: la fuente tiene {3}, que no dan colores; 1 canal sería correcto</translation>
    </message>
    <message>
        <location filename="../../core/picture/map_frame.py"/>
        <source>no imagery at {0} of the image's {1} pixels</source>
        <translation>no hay imágenes en {0} de los {1} píxeles de la imagen</translation>
    </message>
    <message>
        <location filename="../../core/picture/map_frame.py"/>
        <source>part at {0}, {1} px has shape {2} of {3}: {4} of {5} was asked for</source>
        <translation>la parte en {0}, {1} px tiene la forma {2} de {3}: se pidió {4} de {5}</translation>
    </message>
    <message>
        <location filename="../../core/picture/photometry.py"/>
        <source>white balance {0:g} K: needs red, green and blue, and the source gives {1}</source>
        <translation>balance de blancos {0:g} K: necesita rojo, verde y azul, y la fuente da {1}</translation>
    </message>
    <message>
        <location filename="../../core/picture/sensor.py"/>
        <source>colour filters {0}: need red, green and blue, and the source gives {1}</source>
        <translation>filtros de color {0}: necesitan rojo, verde y azul, y la fuente da {1}</translation>
    </message>
    <message>
        <location filename="../../core/picture/sensor.py"/>
        <source>give {0} or more</source>
        <translation>indique {0} o más</translation>
    </message>
    <message>
        <location filename="../../core/picture/sensor.py"/>
        <source>sensitivity ISO {0:g}: below that of the image sensor</source>
        <translation>sensibilidad ISO {0:g}: menor que la del sensor de imagen</translation>
    </message>
    <message>
        <location filename="../../core/poses/gpx.py"/>
        <source>its times go back at point {0:,}</source>
        <translation>sus tiempos retroceden en el punto {0:,}</translation>
    </message>
    <message>
        <location filename="../../core/poses/gpx.py"/>
        <location filename="../../core/poses/logs.py"/>
        <location filename="../../core/poses/trajectories.py"/>
        <source>leave the times out{0}</source>
        <translation>omita los tiempos{0}</translation>
    </message>
    <message>
        <location filename="../../core/poses/gpx.py"/>
        <source>{0}: cannot be read as GPX ({1})</source>
        <translation>{0}: no se puede leer como GPX ({1})</translation>
    </message>
    <message>
        <location filename="../../core/poses/gpx.py"/>
        <source>{0}: has no track points and no route points</source>
        <translation>{0}: no tiene puntos de recorrido ni de ruta</translation>
    </message>
    <message>
        <location filename="../../core/poses/line.py"/>
        <source>file {0}: a corner is not longitude, latitude ({1})</source>
        <translation>archivo {0}: un vértice no es longitud y latitud ({1})</translation>
    </message>
    <message>
        <location filename="../../core/poses/line.py"/>
        <source>file {0}: cannot be read as GeoJSON ({1})</source>
        <translation>archivo {0}: no se puede leer como GeoJSON ({1})</translation>
    </message>
    <message>
        <location filename="../../core/poses/line.py"/>
        <source>file {0}: holds no LineString</source>
        <translation>archivo {0}: no contiene ningún LineString</translation>
    </message>
    <message>
        <location filename="../../core/poses/line.py"/>
        <source>file {0}: its corners have no height above ground</source>
        <translation>archivo {0}: sus vértices no tienen altura sobre el terreno</translation>
    </message>
    <message>
        <location filename="../../core/poses/line.py"/>
        <source>give one for all (--agl)</source>
        <translation>indique una para todos (--agl)</translation>
    </message>
    <message>
        <location filename="../../core/poses/line.py"/>
        <source>line {0}: is a single place</source>
        <translation>línea {0}: es un solo lugar</translation>
    </message>
    <message>
        <location filename="../../core/poses/line.py"/>
        <source>line {0}: turns by {1:.0f} degrees at {2:.6f}, {3:.6f}, between legs of {4:.1f} m and {5:.1f} m</source>
        <translation>línea {0}: gira {1:.0f} grados en {2:.6f}, {3:.6f}, entre tramos de {4:.1f} m y {5:.1f} m</translation>
    </message>
    <message>
        <location filename="../../core/poses/line.py"/>
        <source>line: missing</source>
        <translation>línea: no hay ninguna</translation>
    </message>
    <message>
        <location filename="../../core/poses/line.py"/>
        <source>make two lines of it there, or simplify it</source>
        <translation>divídala allí en dos líneas, o simplifíquela</translation>
    </message>
    <message>
        <location filename="../../core/poses/line.py"/>
        <location filename="../../core/poses/random_poses.py"/>
        <source>{0:,} poses: must be from 1 to {1:,}</source>
        <translation>{0:,} poses: deben ser de 1 a {1:,}</translation>
    </message>
    <message>
        <location filename="../../core/poses/logs.py"/>
        <source>choose one of them{0}</source>
        <translation>elija uno de ellos{0}</translation>
    </message>
    <message>
        <location filename="../../core/poses/logs.py"/>
        <source>flight {0} of log {1}: must be from 1 to {2}</source>
        <translation>vuelo {0} del registro {1}: debe ser de 1 a {2}</translation>
    </message>
    <message>
        <location filename="../../core/poses/logs.py"/>
        <source>get it with: pip install 'terrainav[{0}]'</source>
        <translation>se obtiene con: pip install 'terrainav[{0}]'</translation>
    </message>
    <message>
        <location filename="../../core/poses/logs.py"/>
        <source>log {0}: cannot be read as DataFlash ({1})</source>
        <translation>registro {0}: no se puede leer como DataFlash ({1})</translation>
    </message>
    <message>
        <location filename="../../core/poses/logs.py"/>
        <source>log {0}: cannot be read as ULog ({1})</source>
        <translation>registro {0}: no se puede leer como ULog ({1})</translation>
    </message>
    <message>
        <location filename="../../core/poses/logs.py"/>
        <source>log {0}: has no positions ({1})</source>
        <translation>registro {0}: no tiene posiciones ({1})</translation>
    </message>
    <message>
        <location filename="../../core/poses/logs.py"/>
        <source>log {0}: is empty</source>
        <translation>registro {0}: está vacío</translation>
    </message>
    <message>
        <location filename="../../core/poses/logs.py"/>
        <source>log {0}: its clock starts again at position {1:,}: it holds {2} flights</source>
        <translation>registro {0}: su reloj vuelve a empezar en la posición {1:,}: contiene {2} vuelos</translation>
    </message>
    <message>
        <location filename="../../core/poses/logs.py"/>
        <source>log {0}: none of its {1:,} positions has a place and a height</source>
        <translation>registro {0}: ninguna de sus {1:,} posiciones tiene lugar y altura</translation>
    </message>
    <message>
        <location filename="../../core/poses/logs.py"/>
        <source>log {0}: {1}</source>
        <translation>registro {0}: {1}</translation>
    </message>
    <message>
        <location filename="../../core/poses/logs.py"/>
        <source>{0}, which reads such files, is not installed</source>
        <translation>{0}, que lee estos archivos, no está instalado</translation>
    </message>
    <message>
        <location filename="../../core/poses/patterns.py"/>
        <source>distance {0:g} m: no place is so far from every wall</source>
        <translation>distancia {0:g} m: ningún lugar está tan alejado de todos los muros</translation>
    </message>
    <message>
        <location filename="../../core/poses/patterns.py"/>
        <source>line of corners at one place: needs two or more</source>
        <translation>línea con vértices en un solo lugar: necesita dos o más</translation>
    </message>
    <message>
        <location filename="../../core/poses/patterns.py"/>
        <source>line of {0:,.0f} km: a pattern reaches up to {1:g} km</source>
        <translation>línea de {0:,.0f} km: un patrón alcanza hasta {1:g} km</translation>
    </message>
    <message>
        <location filename="../../core/poses/patterns.py"/>
        <source>outlines</source>
        <translation>contornos</translation>
    </message>
    <message>
        <location filename="../../core/poses/patterns.py"/>
        <source>take a shorter distance</source>
        <translation>tome una distancia menor</translation>
    </message>
    <message>
        <location filename="../../core/poses/patterns.py"/>
        <source>take shorter lines</source>
        <translation>tome líneas más cortas</translation>
    </message>
    <message>
        <location filename="../../core/poses/patterns.py"/>
        <source>{0:,.0f} poses: must be from 1 to {1:,}</source>
        <translation>{0:,.0f} poses: deben ser de 1 a {1:,}</translation>
    </message>
    <message>
        <location filename="../../core/poses/patterns.py"/>
        <source>{0}: missing</source>
        <translation>{0}: no hay ninguno</translation>
    </message>
    <message>
        <location filename="../../core/poses/priors.py"/>
        <source>folder {0}: its table has no poses of a camera</source>
        <translation>carpeta {0}: su tabla no tiene poses de una cámara</translation>
    </message>
    <message>
        <location filename="../../core/poses/priors.py"/>
        <location filename="../../core/poses/random_poses.py"/>
        <source>seed {0}: must be 0 or more</source>
        <translation>semilla {0}: debe ser 0 o más</translation>
    </message>
    <message>
        <location filename="../../core/poses/random_poses.py"/>
        <source>above 0 m</source>
        <translation>mayor que 0 m</translation>
    </message>
    <message>
        <location filename="../../core/poses/random_poses.py"/>
        <source>area: fills hardly any of the box around it</source>
        <translation>área: apenas ocupa el recuadro que la rodea</translation>
    </message>
    <message>
        <location filename="../../core/poses/random_poses.py"/>
        <source>choose an area that lies farther inside, lower heights, or less tilt</source>
        <translation>elija una zona más al interior, alturas menores o menos inclinación</translation>
    </message>
    <message>
        <location filename="../../core/poses/random_poses.py"/>
        <source>distribution {0!r}: must be a number, uniform LOW HIGH or normal MEAN DEVIATION</source>
        <translation>distribución {0!r}: debe ser un número, uniform MÍNIMO MÁXIMO o normal MEDIA DESVIACIÓN</translation>
    </message>
    <message>
        <location filename="../../core/poses/random_poses.py"/>
        <source>distribution {0!r}: must be a number, uniform or normal</source>
        <translation>distribución {0!r}: debe ser un número, uniform o normal</translation>
    </message>
    <message>
        <location filename="../../core/poses/random_poses.py"/>
        <source>distribution {0}: its numbers must be finite</source>
        <translation>distribución {0}: sus números deben ser finitos</translation>
    </message>
    <message>
        <location filename="../../core/poses/random_poses.py"/>
        <source>distribution {0}: the lower end comes first</source>
        <translation>distribución {0}: el extremo inferior va primero</translation>
    </message>
    <message>
        <location filename="../../core/poses/random_poses.py"/>
        <source>distribution {0}: the standard deviation must be 0 or more</source>
        <translation>distribución {0}: la desviación típica debe ser 0 o más</translation>
    </message>
    <message>
        <location filename="../../core/poses/random_poses.py"/>
        <source>give a polygon that is less narrow</source>
        <translation>dé un polígono menos estrecho</translation>
    </message>
    <message>
        <location filename="../../core/poses/random_poses.py"/>
        <source>within 180 degrees</source>
        <translation>de 180 grados como máximo</translation>
    </message>
    <message>
        <location filename="../../core/poses/random_poses.py"/>
        <source>{0:,} of {1:,} poses lie within the imagery with all that they see</source>
        <translation>{0:,} de {1:,} poses quedan dentro de las imágenes con todo lo que ven</translation>
    </message>
    <message>
        <location filename="../../core/poses/random_poses.py"/>
        <source>{0} {1}: hardly any of its numbers are {2}</source>
        <translation>{0} {1}: casi ninguno de sus números es {2}</translation>
    </message>
    <message>
        <location filename="../../core/poses/reading.py"/>
        <source>--flight: is for {0}, and not for {1}</source>
        <translation>--flight: es para {0}, y no para {1}</translation>
    </message>
    <message>
        <location filename="../../core/poses/reading.py"/>
        <source>--origin, --body and --world: are for {0}, and not for {1}</source>
        <translation>--origin, --body y --world: son para {0}, y no para {1}</translation>
    </message>
    <message>
        <location filename="../../core/poses/reading.py"/>
        <source>at or below the ground</source>
        <translation>en el suelo o debajo de él</translation>
    </message>
    <message>
        <location filename="../../core/poses/reading.py"/>
        <source>give --format</source>
        <translation>indique --format</translation>
    </message>
    <message>
        <location filename="../../core/poses/reading.py"/>
        <source>say where its origin lies (--origin LAT LON [HEIGHT])</source>
        <translation>indique dónde está su origen (--origin LAT LON [HEIGHT])</translation>
    </message>
    <message>
        <location filename="../../core/poses/reading.py"/>
        <source>trajectory {0}</source>
        <translation>trayectoria {0}</translation>
    </message>
    <message>
        <location filename="../../core/poses/reading.py"/>
        <source>trajectory {0}: cannot be read ({1})</source>
        <translation>trayectoria {0}: no se puede leer ({1})</translation>
    </message>
    <message>
        <location filename="../../core/poses/reading.py"/>
        <source>trajectory {0}: its ending does not tell its format</source>
        <translation>trayectoria {0}: su extensión no indica su formato</translation>
    </message>
    <message>
        <location filename="../../core/poses/reading.py"/>
        <source>trajectory {0}: no such file</source>
        <translation>trayectoria {0}: no existe tal archivo</translation>
    </message>
    <message>
        <location filename="../../core/poses/reading.py"/>
        <source>trajectory {0}: {1} is in metres of a local frame</source>
        <translation>trayectoria {0}: {1} está en metros de un sistema local</translation>
    </message>
    <message>
        <location filename="../../core/poses/reading.py"/>
        <source>unit of times {0}: is for {1}, and not for {2}</source>
        <translation>unidad de tiempos {0}: es para {1}, y no para {2}</translation>
    </message>
    <message>
        <location filename="../../core/poses/reading.py"/>
        <source>without a place</source>
        <translation>sin lugar</translation>
    </message>
    <message>
        <location filename="../../core/poses/reading.py"/>
        <source>without a time</source>
        <translation>sin tiempo</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>&amp;Bank in turns</source>
        <translation>Inclinación lateral en los vira&amp;jes</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>&amp;Circles</source>
        <translation>&amp;Círculos</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>&amp;Distance</source>
        <translation>&amp;Distancia</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>&amp;Flight of the log</source>
        <translation>&amp;Vuelo del registro</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>&amp;Format</source>
        <translation>&amp;Formato</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>&amp;Highest height</source>
        <translation>Altura &amp;máxima</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>&amp;Images per circle</source>
        <translation>&amp;Imágenes por círculo</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>&amp;Lowest height</source>
        <translation>A&amp;ltura mínima</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>&amp;Offset to the right</source>
        <translation>&amp;Desplazamiento a la derecha</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>&amp;Origin: latitude, longitude, height</source>
        <translation>&amp;Origen: latitud, longitud, altura</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>&amp;Radius</source>
        <translation>&amp;Radio</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>&amp;Speed</source>
        <translation>V&amp;elocidad</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>&amp;Tilt</source>
        <translation>&amp;Inclinación</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>&amp;Times</source>
        <translation>&amp;Tiempos</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>&amp;Width</source>
        <translation>&amp;Ancho</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>A&amp;xes of the frame</source>
        <translation>E&amp;jes del sistema</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>ArduPilot log (DataFlash)</source>
        <translation>Registro de ArduPilot (DataFlash)</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>Camera rolls with the aircr&amp;aft</source>
        <translation>La cámara alabea con la aero&amp;nave</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>EuRoC trajectory</source>
        <translation>Trayectoria EuRoC</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>EuRoC's inertial unit (up, right, forward)</source>
        <translation>unidad inercial de EuRoC (arriba, derecha, adelante)</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>GPX track</source>
        <translation>Track GPX</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>Gimbal keeps the camera straight &amp;down</source>
        <translation>El car&amp;dán mantiene la cámara vertical hacia abajo</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>Height of the &amp;target</source>
        <translation>Altura del &amp;objetivo</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>Litchi mission</source>
        <translation>Misión de Litchi</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>PX4 log (ULog)</source>
        <translation>Registro de PX4 (ULog)</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>Poses &amp;are of</source>
        <translation>Las &amp;poses son de</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>a gimbal keeps the camera straight down: take only the yaw of the attitude</source>
        <translation>un cardán mantiene la cámara vertical hacia abajo: tomar de la actitud solo la guiñada</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>aircraft (forward, left, up)</source>
        <translation>aeronave (adelante, izquierda, arriba)</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>aircraft (forward, right, down)</source>
        <translation>aeronave (adelante, derecha, abajo)</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>axes of the frame</source>
        <translation>ejes del sistema</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>axes of the frame that the poses are in</source>
        <translation>ejes del sistema en el que están las poses</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>axes of what the poses are of</source>
        <translation>ejes de aquello a lo que pertenecen las poses</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>bank in turns</source>
        <translation>inclinación lateral en los virajes</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>bank in turns; with the speed, it gives their radius</source>
        <translation>inclinación lateral en los virajes; con la velocidad da su radio</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>camera (right, down, forward)</source>
        <translation>cámara (derecha, abajo, adelante)</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>camera rolls with the aircraft</source>
        <translation>la cámara alabea con la aeronave</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>circles</source>
        <translation>círculos</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>distance</source>
        <translation>distancia</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>distance flown from one exposure to the next</source>
        <translation>distancia volada de una exposición a la siguiente</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>distance interval</source>
        <translation>intervalo de distancia</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>distance of the captures from the centre</source>
        <translation>distancia de las capturas al centro</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>distance of the captures from the wall</source>
        <translation>distancia de las capturas al muro</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>east, north, up</source>
        <translation>este, norte, arriba</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>flight</source>
        <translation>vuelo</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>format</source>
        <translation>formato</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>format of a file with another ending</source>
        <translation>formato de un archivo con otra extensión</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>gimbal keeps the camera straight down</source>
        <translation>el cardán mantiene la cámara vertical hacia abajo</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>give the highest height as well</source>
        <translation>indique también la altura máxima</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>height above ground of the highest circle; left out, there is only one circle</source>
        <translation>altura sobre el terreno del círculo más alto; si se omite, hay un solo círculo</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>height above ground of the highest flight; left out, there is only one flight</source>
        <translation>altura sobre el terreno del vuelo más alto; si se omite, hay un solo vuelo</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>height above ground of the lowest circle</source>
        <translation>altura sobre el terreno del círculo más bajo</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>height above ground of the lowest flight</source>
        <translation>altura sobre el terreno del vuelo más bajo</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>height above ground, at the centre, that the camera looks at</source>
        <translation>altura sobre el terreno, en el centro, a la que mira la cámara</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>height of the ground, as the file counts heights</source>
        <translation>altura del terreno, tal como cuenta las alturas el archivo</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>height of the target</source>
        <translation>altura del objetivo</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>highest height</source>
        <translation>altura máxima</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>highest height {0:g} m: is below the lowest, {1:g} m</source>
        <translation>altura máxima {0:g} m: está por debajo de la mínima, {1:g} m</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>how far to the right of the line the middle of the strip lies</source>
        <translation>a qué distancia a la derecha de la línea está el medio de la franja</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>images per circle</source>
        <translation>imágenes por círculo</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>in microseconds</source>
        <translation>en microsegundos</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>in milliseconds</source>
        <translation>en milisegundos</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>in nanoseconds</source>
        <translation>en nanosegundos</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>in seconds</source>
        <translation>en segundos</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>interval: must be either in seconds or in metres</source>
        <translation>intervalo: debe indicarse en segundos o en metros, uno de los dos</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>keep one position each so many metres of the way</source>
        <translation>conservar una posición cada tantos metros del recorrido</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>keep one position each so many seconds</source>
        <translation>conservar una posición cada tantos segundos</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>latitude, longitude and height of the frame's origin; heights of the file are above that height</source>
        <translation>latitud, longitud y altura del origen del sistema; las alturas del archivo son sobre esa altura</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>lowest height</source>
        <translation>altura mínima</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>mean length of outages {0} s: must be above 0</source>
        <translation>duración media de las interrupciones {0} s: debe ser mayor que 0</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>north, east, down</source>
        <translation>norte, este, abajo</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>number of circles, evenly spaced from the lowest height to the highest</source>
        <translation>número de círculos, a igual distancia entre ellos, de la altura mínima a la máxima</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>number of images on each circle</source>
        <translation>número de imágenes en cada círculo</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>offset</source>
        <translation>desplazamiento</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>one height above ground for all positions</source>
        <translation>una sola altura sobre el terreno para todas las posiciones</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>origin of the local frame</source>
        <translation>origen del sistema local</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>radius</source>
        <translation>radio</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>right, down, forward of a camera that looks north</source>
        <translation>derecha, abajo, adelante de una cámara que mira al norte</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>share of outages {0}: must be from 0 to below 1</source>
        <translation>proporción de interrupciones {0}: debe ser de 0 a menos de 1</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>speed</source>
        <translation>velocidad</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>speed over ground</source>
        <translation>velocidad sobre el terreno</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>the camera is fixed to the aircraft; without this, a gimbal keeps it level in turns</source>
        <translation>la cámara va fija a la aeronave; sin esto, un gimbal la mantiene nivelada en los virajes</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>tilt of the camera: 90 looks level at the wall, less looks down at it</source>
        <translation>inclinación de la cámara: 90 mira al muro en horizontal, menos lo mira desde arriba</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>time from one exposure to the next</source>
        <translation>tiempo de una exposición a la siguiente</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>time interval</source>
        <translation>intervalo de tiempo</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>unit of the times of tum and euroc, or none: times of any format are left out</source>
        <translation>unidad de los tiempos de tum y euroc, o none: se omiten los tiempos de cualquier formato</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>what the poses are of, with its axes; the camera of an aircraft looks down, the top of its image ahead</source>
        <translation>a qué pertenecen las poses, con sus ejes; la cámara de una aeronave mira hacia abajo, con el borde superior de la imagen hacia delante</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>which flight of a log whose clock starts again, from 1</source>
        <translation>qué vuelo de un registro cuyo reloj vuelve a empezar, desde 1</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>width</source>
        <translation>ancho</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>width of the strip along the line; 0 is one row above the line</source>
        <translation>ancho de la franja a lo largo de la línea; 0 es una pasada sobre la línea</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>{0} circles at one height: must be 1</source>
        <translation>{0} círculos a una sola altura: debe ser 1</translation>
    </message>
    <message>
        <location filename="../../core/poses/settings.py"/>
        <source>{0} {1}: must be from 0 to {2:,g}</source>
        <translation>{0} {1}: debe estar entre 0 y {2:,g}</translation>
    </message>
    <message>
        <location filename="../../core/poses/track.py"/>
        <source>give one height above ground{0}</source>
        <translation>indique una sola altura sobre el terreno{0}</translation>
    </message>
    <message>
        <location filename="../../core/poses/track.py"/>
        <source>give one in metres{0}</source>
        <translation>indique uno en metros{0}</translation>
    </message>
    <message>
        <location filename="../../core/poses/track.py"/>
        <source>give that in the heights of the file{0}, or one height above ground{1}</source>
        <translation>indíquela en las alturas del archivo{0}, o una sola altura sobre el terreno{1}</translation>
    </message>
    <message>
        <location filename="../../core/poses/track.py"/>
        <source>give the start to the capture ({0})</source>
        <translation>dé el comienzo a la captura ({0})</translation>
    </message>
    <message>
        <location filename="../../core/poses/track.py"/>
        <source>interval of {0:g} s: the trajectory has no times</source>
        <translation>intervalo de {0:g} s: la trayectoria no tiene tiempos</translation>
    </message>
    <message>
        <location filename="../../core/poses/track.py"/>
        <source>interval of {0} {1}: must be above 0</source>
        <translation>intervalo de {0} {1}: debe ser mayor que 0</translation>
    </message>
    <message>
        <location filename="../../core/poses/track.py"/>
        <source>reading: stopped</source>
        <translation>lectura: detenida</translation>
    </message>
    <message>
        <location filename="../../core/poses/track.py"/>
        <source>start: the trajectory has no times</source>
        <translation>comienzo: la trayectoria no tiene tiempos</translation>
    </message>
    <message>
        <location filename="../../core/poses/track.py"/>
        <source>trajectory: does not say how high its ground is</source>
        <translation>trayectoria: no dice a qué altura está su terreno</translation>
    </message>
    <message>
        <location filename="../../core/poses/track.py"/>
        <source>trajectory: none of its {0:,} positions is above the ground</source>
        <translation>trayectoria: ninguna de sus {0:,} posiciones está sobre el terreno</translation>
    </message>
    <message>
        <location filename="../../core/poses/track.py"/>
        <source>trajectory: position {0:,} has no height</source>
        <translation>trayectoria: la posición {0:,} no tiene altura</translation>
    </message>
    <message>
        <location filename="../../core/poses/trajectories.py"/>
        <source>give --body: urf for that of the published flights, flu or frd for an aircraft's</source>
        <translation>dé --body: urf para la de los vuelos publicados, flu o frd para la de una aeronave</translation>
    </message>
    <message>
        <location filename="../../core/poses/trajectories.py"/>
        <source>give their unit, or leave them out{0}</source>
        <translation>indique su unidad u omítalos{0}</translation>
    </message>
    <message>
        <location filename="../../core/poses/trajectories.py"/>
        <source>{0}, line {1}: {2!r}: must be {3} numbers</source>
        <translation>{0}, línea {1}: {2!r}: deben ser {3} números</translation>
    </message>
    <message>
        <location filename="../../core/poses/trajectories.py"/>
        <source>{0}: EuRoC's poses are those of an inertial unit</source>
        <translation>{0}: las poses de EuRoC son las de una unidad inercial</translation>
    </message>
    <message>
        <location filename="../../core/poses/trajectories.py"/>
        <source>{0}: holds no poses</source>
        <translation>{0}: no contiene poses</translation>
    </message>
    <message>
        <location filename="../../core/poses/trajectories.py"/>
        <source>{0}: its times go back at pose {1:,}</source>
        <translation>{0}: sus tiempos retroceden en la pose {1:,}</translation>
    </message>
    <message>
        <location filename="../../core/poses/trajectories.py"/>
        <source>{0}: pose {1:,} is not a rotation</source>
        <translation>{0}: la pose {1:,} no es una rotación</translation>
    </message>
    <message>
        <location filename="../../core/poses/trajectories.py"/>
        <source>{0}: pose {1:,} must be within {2:,g} m of the origin</source>
        <translation>{0}: la pose {1:,} debe estar a menos de {2:,g} m del origen</translation>
    </message>
    <message>
        <location filename="../../core/poses/trajectories.py"/>
        <source>{0}: the quaternion of pose {1:,} has the length {2:.3g}, and not 1</source>
        <translation>{0}: el cuaternión de la pose {1:,} tiene la longitud {2:.3g}, y no 1</translation>
    </message>
    <message>
        <location filename="../../core/report/heights.py"/>
        <source>profile {0!r}: must end in {1}</source>
        <translation>perfil {0!r}: debe terminar en {1}</translation>
    </message>
    <message>
        <location filename="../../core/report/measure.py"/>
        <source>an image</source>
        <translation>una imagen</translation>
    </message>
    <message>
        <location filename="../../core/report/measure.py"/>
        <source>camera frames</source>
        <translation>encuadres de cámara</translation>
    </message>
    <message>
        <location filename="../../core/report/measure.py"/>
        <source>file formats</source>
        <translation>formatos de archivo</translation>
    </message>
    <message>
        <location filename="../../core/report/measure.py"/>
        <source>footprints</source>
        <translation>huellas</translation>
    </message>
    <message>
        <location filename="../../core/report/measure.py"/>
        <source>vary {0!r}: methods are measured with one camera</source>
        <translation>vary {0!r}: los métodos se miden con una sola cámara</translation>
    </message>
    <message>
        <location filename="../../core/report/measure.py"/>
        <source>what was left out</source>
        <translation>lo que se omitió</translation>
    </message>
    <message>
        <location filename="../../core/report/page.py"/>
        <source>page</source>
        <translation>página</translation>
    </message>
    <message>
        <location filename="../../core/report/sharpness.py"/>
        <source>edge in an image of {0} px: needs one channel of {1} x {1} px or more</source>
        <translation>borde en una imagen de {0} px: requiere un canal de {1} x {1} px o más</translation>
    </message>
    <message>
        <location filename="../../core/report/sharpness.py"/>
        <source>edge slanted by {0:.2f} deg: must be {1:g} to {2:g} deg from rows or columns</source>
        <translation>borde inclinado {0:.2f} grados: debe estar de {1:g} a {2:g} grados de filas o columnas</translation>
    </message>
    <message>
        <location filename="../../core/report/sharpness.py"/>
        <source>edge whose sides differ by {0:.2g} of white: must be {1:g} or more</source>
        <translation>borde cuyos lados difieren en {0:.2g} del blanco: debe ser {1:g} o más</translation>
    </message>
    <message>
        <location filename="../../core/report/sharpness.py"/>
        <source>edge {0:.1f} px from the image's side: must be 2 px or more</source>
        <translation>borde a {0:.1f} px del lado de la imagen: debe ser 2 px o más</translation>
    </message>
    <message>
        <location filename="../../core/sequences/files.py"/>
        <source>fly one</source>
        <translation>vuele una</translation>
    </message>
    <message>
        <location filename="../../core/sequences/files.py"/>
        <source>folder {0}: is not a sequence, as it has no {1}</source>
        <translation>carpeta {0}: no es una secuencia, pues no tiene {1}</translation>
    </message>
    <message>
        <location filename="../../core/sequences/files.py"/>
        <source>has other columns</source>
        <translation>tiene otras columnas</translation>
    </message>
    <message>
        <location filename="../../core/sequences/files.py"/>
        <source>sequence {0}: cannot be read ({1})</source>
        <translation>secuencia {0}: no se puede leer ({1})</translation>
    </message>
    <message>
        <location filename="../../core/sequences/files.py"/>
        <source>version {0}: must be {1}</source>
        <translation>versión {0}: debe ser {1}</translation>
    </message>
    <message>
        <location filename="../../core/storage/config.py"/>
        <source>mend it, or move it away</source>
        <translation>corríjalo o apártelo</translation>
    </message>
    <message>
        <location filename="../../core/storage/config.py"/>
        <source>{0}: cannot be read as JSON ({1})</source>
        <translation>{0}: no se puede leer como JSON ({1})</translation>
    </message>
    <message>
        <location filename="../../core/storage/config.py"/>
        <source>{0}: must hold a JSON object of {1}</source>
        <translation>{0}: debe contener un objeto JSON de {1}</translation>
    </message>
    <message>
        <location filename="../../core/storage/config.py"/>
        <source>{0}; {1} names another folder</source>
        <translation>{0}; {1} indica otra carpeta</translation>
    </message>
    <message>
        <location filename="../../core/storage/files.py"/>
        <source>a line is longer than {0} kB</source>
        <translation>una línea ocupa más de {0} kB</translation>
    </message>
    <message>
        <location filename="../../core/storage/files.py"/>
        <source>file {0}: cannot be read ({1})</source>
        <translation>archivo {0}: no se puede leer ({1})</translation>
    </message>
    <message>
        <location filename="../../core/storage/files.py"/>
        <source>folder {0}: a file is in its place</source>
        <translation>carpeta {0}: hay un archivo en su lugar</translation>
    </message>
    <message>
        <location filename="../../core/storage/files.py"/>
        <location filename="../../terrainav_plugin/remote/copies.py"/>
        <source>folder {0}: cannot be made ({1})</source>
        <translation>carpeta {0}: no se puede crear ({1})</translation>
    </message>
    <message>
        <location filename="../../core/storage/files.py"/>
        <source>folder {0}: is not empty</source>
        <translation>carpeta {0}: no está vacía</translation>
    </message>
    <message>
        <location filename="../../core/storage/files.py"/>
        <source>folder {0}: left over from an interrupted export</source>
        <translation>carpeta {0}: quedó de una exportación que se detuvo</translation>
    </message>
    <message>
        <location filename="../../core/storage/files.py"/>
        <source>folder {0}: must be one of this machine</source>
        <translation>carpeta {0}: debe ser una de este equipo</translation>
    </message>
    <message>
        <location filename="../../core/storage/files.py"/>
        <source>image {0}: cannot be placed ({1})</source>
        <translation>imagen {0}: no se puede colocar ({1})</translation>
    </message>
    <message>
        <location filename="../../core/storage/files.py"/>
        <source>remove it</source>
        <translation>elimínela</translation>
    </message>
    <message>
        <location filename="../../core/storage/files.py"/>
        <source>wait until it has ended or choose another folder</source>
        <translation>espere a que termine o elija otra carpeta</translation>
    </message>
    <message>
        <location filename="../../core/storage/redirects.py"/>
        <source>{0}: its server leads to another one, which is not asked (name that one if it is meant)</source>
        <translation>{0}: su servidor lleva a otro, al que no se pregunta (indique ese si es el deseado)</translation>
    </message>
    <message>
        <location filename="../../core/storage/store_requests.py"/>
        <source>it holds more than {0:,} objects</source>
        <translation>contiene más de {0:,} objetos</translation>
    </message>
    <message>
        <location filename="../../core/storage/store_requests.py"/>
        <source>larger than {0:,.0f} MB</source>
        <translation>mayor que {0:,.0f} MB</translation>
    </message>
    <message>
        <location filename="../../core/storage/store_requests.py"/>
        <source>only {0:,} bytes have come within {1:,.0f} s</source>
        <translation>solo han llegado {0:,} bytes en {1:,.0f} s</translation>
    </message>
    <message>
        <location filename="../../core/storage/store_requests.py"/>
        <source>the answer has not ended within {0:,.0f} s</source>
        <translation>la respuesta no ha terminado en {0:,.0f} s</translation>
    </message>
    <message>
        <location filename="../../core/storage/store_requests.py"/>
        <source>the answer is larger than {0} MB</source>
        <translation>la respuesta ocupa más de {0} MB</translation>
    </message>
    <message>
        <location filename="../../core/storage/stores.py"/>
        <source>address {0!r}: must be a folder, or begin with {1}</source>
        <translation>dirección {0!r}: debe ser una carpeta o empezar por {1}</translation>
    </message>
    <message>
        <location filename="../../core/storage/stores.py"/>
        <source>addresses of object stores: {0} cannot be imported ({1})</source>
        <translation>direcciones de almacenes de objetos: no se puede importar {0} ({1})</translation>
    </message>
    <message>
        <location filename="../../core/storage/stores.py"/>
        <source>credentials are taken from where the store's own tools have them</source>
        <translation>las credenciales se toman de donde las tienen las herramientas del propio almacén</translation>
    </message>
    <message>
        <location filename="../../core/storage/stores.py"/>
        <source>folder</source>
        <translation>carpeta</translation>
    </message>
    <message>
        <location filename="../../core/storage/stores.py"/>
        <location filename="../../terrainav_plugin/qgis_source/vector_files.py"/>
        <source>folder {0}: cannot be written ({1})</source>
        <translation>carpeta {0}: no se puede escribir ({1})</translation>
    </message>
    <message>
        <location filename="../../core/storage/stores.py"/>
        <source>get it with: pip install {0}</source>
        <translation>instálelo con: pip install {0}</translation>
    </message>
    <message>
        <location filename="../../core/storage/stores.py"/>
        <source>make the bucket first</source>
        <translation>cree antes el «bucket»</translation>
    </message>
    <message>
        <location filename="../../core/storage/stores.py"/>
        <source>{0} {1}://…: no user name, password, key or signature may stand in it ({2})</source>
        <translation>{0} {1}://…: no puede contener nombre de usuario, contraseña, clave ni firma ({2})</translation>
    </message>
    <message>
        <location filename="../../core/storage/stores.py"/>
        <source>{0}: access is refused: the credentials do not allow it</source>
        <translation>{0}: se deniega el acceso: las credenciales no lo permiten</translation>
    </message>
    <message>
        <location filename="../../core/storage/stores.py"/>
        <source>{0}: cannot be reached ({1})</source>
        <translation>{0}: no se puede acceder ({1})</translation>
    </message>
    <message>
        <location filename="../../core/storage/stores.py"/>
        <source>{0}: is not there, or {1} is not</source>
        <translation>{0}: no existe, o no existe {1}</translation>
    </message>
    <message>
        <location filename="../../core/storage/stores.py"/>
        <source>{0}: no valid credentials: they are taken from where the store's own tools have them</source>
        <translation>{0}: no hay credenciales válidas: se toman de donde las tienen las herramientas propias del almacén</translation>
    </message>
    <message>
        <location filename="../../core/storage/stores.py"/>
        <source>{0}: the credentials have expired: new ones are taken from where the store's own tools have them</source>
        <translation>{0}: las credenciales han caducado: las nuevas se toman de donde las tienen las herramientas propias del almacén</translation>
    </message>
    <message>
        <location filename="../../core/text/plain.py"/>
        <source>{0} time {1!r}: must be as 2024-06-21T10:30:00Z, or seconds after 1970</source>
        <translation>{0} hora {1!r}: debe ser como 2024-06-21T10:30:00Z, o segundos desde 1970</translation>
    </message>
    <message>
        <location filename="../../core/text/safe_json.py"/>
        <source>a whole number of {0:,} digits: {1} at most</source>
        <translation>un número entero de {0:,} cifras: {1} como máximo</translation>
    </message>
    <message>
        <location filename="../../core/text/safe_json.py"/>
        <source>nested too deep: {0} levels at most</source>
        <translation>anidado demasiado hondo: {0} niveles como máximo</translation>
    </message>
    <message>
        <location filename="../../core/text/safe_json.py"/>
        <source>not UTF-8: byte {0} is invalid</source>
        <translation>no es texto en UTF-8: el byte {0} no le corresponde</translation>
    </message>
    <message>
        <location filename="../../core/text/safe_json.py"/>
        <source>number {0}: too large</source>
        <translation>número {0}: demasiado grande</translation>
    </message>
    <message>
        <location filename="../../core/text/safe_json.py"/>
        <source>{0} alone is half a character</source>
        <translation>{0} solo es medio carácter</translation>
    </message>
    <message>
        <location filename="../../core/text/safe_json.py"/>
        <source>{0}: JSON has finite numbers only</source>
        <translation>{0}: JSON solo tiene números finitos</translation>
    </message>
    <message>
        <location filename="../../core/text/safe_xml.py"/>
        <source>a document type or entities, which are not read</source>
        <translation>tipo de documento o entidades propias, que no se leen</translation>
    </message>
    <message>
        <location filename="../../core/text/safe_xml.py"/>
        <source>elements nested more than {0} deep</source>
        <translation>elementos anidados a más de {0} niveles</translation>
    </message>
    <message>
        <location filename="../../core/text/safe_xml.py"/>
        <source>encoding {0}: must be {1}</source>
        <translation>codificación {0}: debe ser {1}</translation>
    </message>
    <message>
        <location filename="../../core/text/safe_xml.py"/>
        <source>is not {0}; must be {1}, and say which</source>
        <translation>no es {0}; debe ser {1}, e indicar cuál</translation>
    </message>
    <message>
        <location filename="../../core/text/safe_xml.py"/>
        <source>layers that pass on more than {0:,} properties to those within them</source>
        <translation>capas que transmiten más de {0:,} propiedades a las que contienen</translation>
    </message>
    <message>
        <location filename="../../core/text/safe_xml.py"/>
        <source>more than {0:,} attributes of one element</source>
        <translation>más de {0:,} atributos de un elemento</translation>
    </message>
    <message>
        <location filename="../../core/text/safe_xml.py"/>
        <source>more than {0:,} different names</source>
        <translation>más de {0:,} nombres distintos</translation>
    </message>
    <message>
        <location filename="../../core/text/safe_xml.py"/>
        <source>more than {0:,} elements and attributes</source>
        <translation>más de {0:,} elementos y atributos</translation>
    </message>
    <message>
        <location filename="../../core/text/safe_xml.py"/>
        <source>more than {0:,} layers and styles</source>
        <translation>más de {0:,} capas y estilos</translation>
    </message>
    <message>
        <location filename="../../core/text/safe_xml.py"/>
        <source>more than {0} MB or {1:,} elements</source>
        <translation>más de {0} MB o {1:,} elementos</translation>
    </message>
    <message>
        <location filename="../../core/units.py"/>
        <source>DN</source>
        <translation>DN</translation>
    </message>
    <message>
        <location filename="../../core/units.py"/>
        <source>DN/e-</source>
        <translation>DN/e-</translation>
    </message>
    <message>
        <location filename="../../core/units.py"/>
        <source>Hz</source>
        <translation>Hz</translation>
    </message>
    <message>
        <location filename="../../core/units.py"/>
        <source>cycles per px</source>
        <translation>ciclos por px</translation>
    </message>
    <message>
        <location filename="../../core/units.py"/>
        <source>cycles/px</source>
        <translation>ciclos/px</translation>
    </message>
    <message>
        <location filename="../../core/units.py"/>
        <source>deg</source>
        <translation>grados</translation>
    </message>
    <message>
        <location filename="../../core/units.py"/>
        <source>degrees</source>
        <translation>grados</translation>
    </message>
    <message>
        <location filename="../../core/units.py"/>
        <source>digital numbers</source>
        <translation>números digitales</translation>
    </message>
    <message>
        <location filename="../../core/units.py"/>
        <source>digital numbers per electron</source>
        <translation>números digitales por electrón</translation>
    </message>
    <message>
        <location filename="../../core/units.py"/>
        <source>electrons</source>
        <translation>electrones</translation>
    </message>
    <message>
        <location filename="../../core/units.py"/>
        <source>electrons per second</source>
        <translation>electrones por segundo</translation>
    </message>
    <message>
        <location filename="../../core/units.py"/>
        <source>hertz</source>
        <translation>hercios</translation>
    </message>
    <message>
        <location filename="../../core/units.py"/>
        <source>kelvins</source>
        <translation>kelvin</translation>
    </message>
    <message>
        <location filename="../../core/units.py"/>
        <source>kilometres</source>
        <translation>kilómetros</translation>
    </message>
    <message>
        <location filename="../../core/units.py"/>
        <source>km</source>
        <translation>km</translation>
    </message>
    <message>
        <location filename="../../core/units.py"/>
        <source>lux</source>
        <translation>lux</translation>
    </message>
    <message>
        <location filename="../../core/units.py"/>
        <source>lx</source>
        <translation>lx</translation>
    </message>
    <message>
        <location filename="../../core/units.py"/>
        <source>metres</source>
        <translation>metros</translation>
    </message>
    <message>
        <location filename="../../core/units.py"/>
        <source>metres per second</source>
        <translation>metros por segundo</translation>
    </message>
    <message>
        <location filename="../../core/units.py"/>
        <source>micrometres</source>
        <translation>micrómetros</translation>
    </message>
    <message>
        <location filename="../../core/units.py"/>
        <source>min</source>
        <translation>min</translation>
    </message>
    <message>
        <location filename="../../core/units.py"/>
        <source>minutes</source>
        <translation>minutos</translation>
    </message>
    <message>
        <location filename="../../core/units.py"/>
        <source>ms</source>
        <translation>ms</translation>
    </message>
    <message>
        <location filename="../../core/units.py"/>
        <source>percent</source>
        <translation>porcentaje</translation>
    </message>
    <message>
        <location filename="../../core/units.py"/>
        <source>px</source>
        <translation>px</translation>
    </message>
    <message>
        <location filename="../../core/units.py"/>
        <source>share</source>
        <translation>fracción</translation>
    </message>
    <message>
        <location filename="../../core/vectors/geojson.py"/>
        <location filename="../../core/vectors/reading.py"/>
        <source>{0}: not a vector file that can be read</source>
        <translation>{0}: no es un archivo vectorial que se pueda leer</translation>
    </message>
    <message>
        <location filename="../../core/vectors/layer.py"/>
        <source>field {0!r} of {1}: more than {2:,} distinct values, which 16 bits cannot hold</source>
        <translation>campo {0!r} de {1}: más de {2:,} valores distintos, que no caben en 16 bits</translation>
    </message>
    <message>
        <location filename="../../core/vectors/layer.py"/>
        <source>layer {0} of {1}: has no features with a geometry</source>
        <translation>capa {0} de {1}: no tiene objetos con geometría</translation>
    </message>
    <message>
        <location filename="../../core/vectors/layer.py"/>
        <source>layer {0} of {1}: has no reference system (CRS), so nobody can place it on the Earth</source>
        <translation>capa {0} de {1}: no tiene sistema de referencia (SRC), así que no se puede situar en la Tierra</translation>
    </message>
    <message>
        <location filename="../../core/vectors/layer.py"/>
        <source>{0}: has no field {1!r}, but {2}</source>
        <translation>{0}: no tiene el campo {1!r}, sino {2}</translation>
    </message>
    <message>
        <location filename="../../core/vectors/layer.py"/>
        <source>{0}: opening…</source>
        <translation>{0}: abriendo…</translation>
    </message>
    <message>
        <location filename="../../core/vectors/layer.py"/>
        <source>{0}: {1:,} features read</source>
        <translation>{0}: leídos {1:,} elementos</translation>
    </message>
    <message>
        <location filename="../../core/vectors/layer.py"/>
        <source>{0}: {1:,} of {2:,} features read</source>
        <translation>{0}: leídos {1:,} de {2:,} elementos</translation>
    </message>
    <message>
        <location filename="../../core/vectors/names.py"/>
        <source>{0}: no such file</source>
        <translation>{0}: no existe tal archivo</translation>
    </message>
    <message>
        <location filename="../../core/vectors/reading.py"/>
        <source>{0}: has no layer {1!r}, but {2}</source>
        <translation>{0}: no tiene la capa {1!r}, sino {2}</translation>
    </message>
    <message>
        <location filename="../../core/vectors/reading.py"/>
        <source>{0}: has no layers</source>
        <translation>{0}: no tiene capas</translation>
    </message>
    <message>
        <location filename="../../core/vectors/reading.py"/>
        <source>{0}: has several layers; name one of {1}</source>
        <translation>{0}: tiene varias capas; indique una de {1}</translation>
    </message>
    <message>
        <location filename="../../core/vectors/reading.py"/>
        <source>{0}: refers to other files; name these</source>
        <translation>{0}: remite a otros archivos; indique estos</translation>
    </message>
    <message>
        <location filename="../../core/vectors/shaping.py"/>
        <source>reference system cannot be read: {0}</source>
        <translation>no se puede leer el sistema de referencia: {0}</translation>
    </message>
    <message>
        <location filename="../../core/waiting.py"/>
        <source>stopped</source>
        <translation>interrumpido</translation>
    </message>
    <message>
        <location filename="../../core/world/source.py"/>
        <source>CRS {0!r}: the synthetic world has {1}</source>
        <translation>SRC {0!r}: el mundo sintético tiene {1}</translation>
    </message>
    <message>
        <location filename="../../core/world/source.py"/>
        <source>choose EPSG:3413 around the North Pole, EPSG:3031 around the South Pole, or none elsewhere</source>
        <translation>elija EPSG:3413 en torno al polo norte, EPSG:3031 en torno al polo sur, o ninguno en otra parte</translation>
    </message>
    <message>
        <location filename="../../core/world/source.py"/>
        <source>map type {0!r}: the synthetic world has {1}</source>
        <translation>tipo de mapa {0!r}: el mundo sintético tiene {1}</translation>
    </message>
    <message>
        <location filename="../../core/world/source.py"/>
        <source>position outside the world: u must be finite and v from 0 to 1</source>
        <translation>posición fuera del mundo: u debe ser finito y v estar entre 0 y 1</translation>
    </message>
    <message>
        <location filename="../../core/world/source.py"/>
        <source>seed {0}: must be from 0 to 2**64 - 1</source>
        <translation>semilla {0}: debe estar entre 0 y 2**64 - 1</translation>
    </message>
    <message>
        <location filename="../../core/world/source.py"/>
        <source>tile x {0}, y {1} at zoom {2}: both must be from 0 to {3}</source>
        <translation>tesela x {0}, y {1} con zoom {2}: ambos deben estar entre 0 y {3}</translation>
    </message>
    <message>
        <location filename="../../core/world/source.py"/>
        <source>zoom {0:g} to {1:g}: must be from 0 to {2}</source>
        <translation>zoom de {0:g} a {1:g}: debe estar entre 0 y {2}</translation>
    </message>
    <message>
        <location filename="../../core/world/source.py"/>
        <source>zoom {0}: must be from 0 to {1}</source>
        <translation>zoom {0}: debe estar entre 0 y {1}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/layers.py"/>
        <source>failed images of {0}: cannot be written ({1})</source>
        <translation>imágenes fallidas de {0}: no se pueden escribir ({1})</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/layers.py"/>
        <source>footprints {0}: QGIS cannot open them</source>
        <translation>huellas {0}: QGIS no puede abrirlas</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/layers.py"/>
        <source>image {0}: QGIS cannot open it</source>
        <translation>imagen {0}: QGIS no puede abrirla</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/mosaic.py"/>
        <source>file {0}: cannot be replaced ({1})</source>
        <translation>archivo {0}: no se puede sustituir ({1})</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/mosaic.py"/>
        <location filename="../../terrainav_plugin/dataset/rectify.py"/>
        <source>mosaic {0}: cannot be made ({1})</source>
        <translation>mosaico {0}: no se puede crear ({1})</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/mosaic.py"/>
        <source>mosaic {0}: cannot be read ({1})</source>
        <translation>mosaico {0}: no se puede leer ({1})</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/dataset/rectify.py"/>
        <location filename="../../terrainav_plugin/remote/images.py"/>
        <source>image {0}: cannot be written ({1})</source>
        <translation>imagen {0}: no se puede escribir ({1})</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/live/source.py"/>
        <source>live view: closed</source>
        <translation>vista en directo: cerrada</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/network/answers.py"/>
        <source>the proxy asks for a user name and password</source>
        <translation>el proxy pide usuario y contraseña</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/network/worker.py"/>
        <source>QGIS could not apply the authentication configuration {0}</source>
        <translation>QGIS no ha podido aplicar la configuración de autenticación {0}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/network/worker.py"/>
        <source>QGIS's authentication database is locked: enter its master password, then try again</source>
        <translation>La base de datos de autenticación de QGIS está bloqueada: introduzca su contraseña maestra e inténtelo de nuevo</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/preview/background.py"/>
        <source>background {0}: cannot be written ({1})</source>
        <translation>fondo {0}: no se puede escribir ({1})</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/preview/background.py"/>
        <source>background: stopped</source>
        <translation>fondo: detenido</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/qgis_source/renderer.py"/>
        <source>QGIS could not draw it: {0}</source>
        <translation>QGIS no ha podido dibujarlo: {0}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/qgis_source/renderer.py"/>
        <source>QGIS could not read it: {0}</source>
        <translation>QGIS no ha podido leerlo: {0}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/qgis_source/renderer.py"/>
        <source>QGIS had not drawn it after {0:.0f} s</source>
        <translation>QGIS no lo había dibujado tras {0:.0f} s</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/qgis_source/renderer.py"/>
        <source>cancelled while drawing the map</source>
        <translation>cancelado mientras se dibujaba el mapa</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/qgis_source/renderer.py"/>
        <source>image of {0}x{1} px: too large to be drawn</source>
        <translation>imagen de {0}x{1} px: demasiado grande para dibujarla</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/qgis_source/source.py"/>
        <source>{0} shows nothing here</source>
        <translation>{0} no muestra nada aquí</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/qgis_source/vector_files.py"/>
        <source>layer {0}: cannot be written to {1} ({2})</source>
        <translation>capa {0}: no se puede escribir en {1} ({2})</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/remote/address.py"/>
        <source>environment variable AWS_ENDPOINT_URL: must be such as {0}</source>
        <translation>variable de entorno AWS_ENDPOINT_URL: debe ser como {0}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/remote/store.py"/>
        <source>{0}: has changed while it was read</source>
        <translation>{0}: ha cambiado mientras se leía</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/remote/store.py"/>
        <source>{0}: has {1} bytes, more than {2}</source>
        <translation>{0}: tiene {1} bytes, más de {2}</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/remote/store.py"/>
        <source>{0}: sends whole files only, and images in shards are parts of files</source>
        <translation>{0}: solo envía archivos enteros, y las imágenes en fragmentos son partes de archivos</translation>
    </message>
    <message>
        <location filename="../../terrainav_plugin/remote/store.py"/>
        <source>{0}: the server sent another part than asked for</source>
        <translation>{0}: el servidor envió una parte distinta de la solicitada</translation>
    </message>
</context>
</TS>
